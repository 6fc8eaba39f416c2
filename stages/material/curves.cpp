// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/material/curves.h"

#include <cmath>

#include <fmt/format.h>

namespace pneuma::stages::material {

namespace {

namespace law = solver::material;

bool pull(law::TestPiece& piece, const law::Control& control, double to, std::optional<double> rate) {
  if (!rate) return piece.advance(control, to);
  const double from = piece.driven(control);
  for (int i = 1; i <= steps_in_time; ++i) {
    const double next = from + (to - from) * i / steps_in_time;
    if (!piece.advance(control, next, std::abs(to - from) / steps_in_time / *rate)) return false;
  }
  return true;
}

} // namespace

Shown shown(const PieceState& state, bool true_measures) {
  const base::Vec3 strain = true_measures ? state.logarithmic_strain() : state.engineering_strain();
  const base::Vec3 stress = true_measures ? state.true_stress() : state.nominal_stress();
  return {strain, stress};
}

law::Control control_of(const Ratio& ratio) {
  return ratio.shear ? law::shear() : law::biaxial(ratio.a, ratio.b);
}

double engineering(double strain, bool true_measures) {
  return true_measures ? std::expm1(strain) : strain;
}

Curve follow(const law::Law& material, const Ratio& ratio, const Options& options, std::optional<double> rate) {
  Curve curve;
  curve.ratio = ratio;
  curve.rate = rate;
  law::TestPiece piece(material, options.angle);
  const law::Control control = control_of(ratio);
  const auto to = [&](int step) { return engineering(options.strain * step / options.steps, options.true_measures); };
  curve.loading.push_back(piece.state());
  for (int i = 1; i <= options.steps; ++i) {
    if (!pull(piece, control, to(i), rate)) {
      const char* why = piece.status() == law::Status::outside_data ? "its data end there" : "it knows no state beyond";
      curve.end = fmt::format("ends at a strain of {:.3g} %: {}", 100 * to(i - 1), why);
      break;
    }
    curve.loading.push_back(piece.state());
  }
  const int axis = driven_axis(ratio);
  const auto force = [axis](const law::TestPiece& at) { return at.state().nominal_stress()[axis]; };
  const double none = 1e-9 * force(piece); // rounding of an elastic foil that is back
  for (int i = static_cast<int>(curve.loading.size()) - 2; force(piece) > none; --i) {
    law::TestPiece next = piece;
    if (!pull(next, control, to(i), rate)) return curve;
    if (std::abs(force(next)) <= none) { // back at its start: no way there by force where the stress does not rise
      curve.unloading.push_back(next.state());
      return curve;
    }
    if (force(next) < 0) {
      const double part = force(piece) / (force(piece) - force(next));
      const double duration = rate ? part * (next.state().time - piece.state().time) : 0;
      if (piece.advance(law::stresses({ratio.a, ratio.b, ratio.shear ? 1.0 : 0.0}), 0, duration))
        curve.unloading.push_back(piece.state());
      return curve;
    }
    piece = next;
    curve.unloading.push_back(piece.state());
  }
  return curve;
}

} // namespace pneuma::stages::material
