// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/analytical/circular_membrane.h"

#include <array>
#include <cmath>

#include "solver/analytical/root.h"

namespace pneuma::solver::analytical {

namespace {

// The membrane measured from its stress-free state: a pretension is a stretch g of a smaller disc.
struct PretensionedFoil {
  double c; // E h / (1 - nu^2), N/m
  double nu;

  double nominal_meridional(double ls, double lh) const { return ls * c * 0.5 * ((ls * ls - 1) + nu * (lh * lh - 1)); }
  double nominal_hoop(double ls, double lh) const { return nominal_meridional(lh, ls); }

  // l_s with nominal_meridional = T, on the branch where T grows with l_s
  double meridional_stretch(double T, double lh) const {
    double ls = std::max(1.0, lh);
    for (int i = 0; i < 60; ++i) {
      const double slope = 0.5 * c * (3 * ls * ls - 1 + nu * (lh * lh - 1));
      const double change = (nominal_meridional(ls, lh) - T) / slope;
      ls -= change;
      if (std::abs(change) < 1e-15 * ls) break;
    }
    return ls;
  }
};

// Any law in two stretches.
struct Film {
  const StretchLaw& law;
  double thickness;

  double nominal_meridional(double ls, double lh) const { return thickness * energy(law, ls, lh).w1; }
  double nominal_hoop(double ls, double lh) const { return thickness * energy(law, ls, lh).w2; }

  // l_s with nominal_meridional = T > 0: laws stiffen from where they carry nothing, or soften from there
  double meridional_stretch(double T, double lh) const {
    double ls = std::max(1.0, lh);
    for (int i = 0; i < 60; ++i) {
      const Energy e = energy(law, ls, lh);
      const double change = (thickness * e.w1 - T) / (thickness * e.w11);
      ls = std::max(ls - change, 0.5 * ls);
      if (std::abs(change) < 1e-15 * ls) break;
    }
    return ls;
  }
};

using Vector = std::array<double, 4>; // y = r/R, eta = T_s cos(phi), depth = int l_s sin(phi) dR, volume

template <class Law>
struct Problem {
  Law law;
  double pressure;
  double rim; // stress-free radius of the rim, m: t = ln(R / rim)

  struct Local {
    double ls, lh, sine, cosine, Ts;
  };
  Local local(double R, const Vector& v) const {
    const double vertical = 0.5 * pressure * v[0] * v[0] * R; // T_s sin(phi) = p r^2 / (2 R)
    const double Ts = std::hypot(v[1], vertical);
    return {law.meridional_stretch(Ts, v[0]), v[0], vertical / Ts, v[1] / Ts, Ts};
  }
  Vector derivative(double t, const Vector& v) const {
    const double R = rim * std::exp(t);
    const Local l = local(R, v);
    const double r = v[0] * R;
    return {l.ls * l.cosine - v[0], law.nominal_hoop(l.ls, l.lh) - pressure * r * l.ls * l.sine - v[1],
            l.ls * l.sine * R, std::acos(-1.0) * r * r * l.ls * l.sine * R};
  }
  // from the pole (stretch l0) to the rim; sees every station
  template <class See>
  Vector integrate(double l0, int steps, const See& see) const {
    const double h = -start / steps;
    Vector v = at_pole(l0);
    for (int i = 0; i < steps; ++i) {
      const double t = start + i * h;
      see(t, v);
      v = step(t, h, v);
    }
    see(0, v);
    return v;
  }

  static constexpr double start = -16; // R = 1e-7 rim: the pole's values hold to its square
  Vector at_pole(double l0) const { return {l0, law.nominal_meridional(l0, l0), 0, 0}; }

  // of Runge and Kutta's method of fourth order
  Vector step(double t, double h, const Vector& v) const {
    const auto plus = [](const Vector& a, double s, const Vector& b) {
      return Vector{a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2], a[3] + s * b[3]};
    };
    const Vector k1 = derivative(t, v);
    const Vector k2 = derivative(t + h / 2, plus(v, h / 2, k1));
    const Vector k3 = derivative(t + h / 2, plus(v, h / 2, k2));
    const Vector k4 = derivative(t + h, plus(v, h, k3));
    Vector next = v;
    for (std::size_t j = 0; j < 4; ++j) next[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    return next;
  }
};

} // namespace

std::optional<InflatedCircle> inflate(const CircularMembrane& membrane, double pressure, int steps) {
  const double nu = membrane.poissons_ratio;
  const PretensionedFoil law{membrane.stiffness / (1 - nu * nu), nu};
  // pretension N0 = E h/(1-nu) (g^2-1)/2: the stress-free disc is smaller by g
  const double g = std::sqrt(1 + 2 * membrane.pretension * (1 - nu) / membrane.stiffness);
  const Problem<PretensionedFoil> problem{law, pressure, membrane.radius / g};
  const auto ignore = [](double, const Vector&) {};
  // the rim's stretch r/R grows with the pole's stretch; wanted: g
  const auto miss = [&](double l0) { return problem.integrate(l0, steps, ignore)[0] - g; };
  double step = 1e-3, low = g, high = g + step;
  while (high <= 3 && !(miss(high) > 0)) {
    step *= 2;
    low = high;
    high = g + step;
  }
  if (!(high <= 3)) return std::nullopt;
  const double l0 = root_between(low, high, miss);

  InflatedCircle result;
  result.pressure = pressure;
  const Vector end = problem.integrate(l0, steps, [&](double t, const Vector& v) {
    const double R = problem.rim * std::exp(t);
    const auto l = problem.local(R, v);
    // nominal force per reference length -> Cauchy per current length: divide by the other direction's stretch
    result.meridian.push_back({R * g, v[0] * R, -v[2], l.Ts / l.lh, law.nominal_hoop(l.ls, l.lh) / l.ls});
  });
  for (MeridianPoint& point : result.meridian) point.height += end[2];
  result.deflection = end[2];
  result.volume = end[3];
  result.apex_tension = law.nominal_meridional(l0, l0) / l0;
  result.pole_stretch = l0;
  return result;
}

std::optional<InflatedCircle> inflate_to(const CircularDisc& disc, double pole_stretch, int steps) {
  if (!(pole_stretch > 1)) return std::nullopt;
  // a pressure whose membrane has about the disc's radius: of a cap with the pole's tension over twice its radius, less
  // where the cap is flat
  const Film film{disc.law, disc.thickness};
  const double tension = film.nominal_meridional(pole_stretch, pole_stretch) / pole_stretch;
  const double pressure = tension / disc.radius * std::min(1.0, std::sqrt(pole_stretch - 1));
  const Problem<Film> problem{film, pressure, disc.radius};
  const double h = -Problem<Film>::start / steps;
  const auto draw = [&](double t, const Vector& v, std::vector<MeridianPoint>& meridian) {
    const auto l = problem.local(disc.radius * std::exp(t), v);
    meridian.push_back({std::exp(t), v[0] * std::exp(t), -v[2], l.Ts / l.lh, film.nominal_hoop(l.ls, l.lh) / l.ls});
  };
  InflatedCircle result;
  Vector v = problem.at_pole(pole_stretch);
  double t = Problem<Film>::start;
  constexpr double far = 16;
  while (v[0] > 1) {
    draw(t, v, result.meridian);
    const Vector next = problem.step(t, h, v);
    if (!(t < far) || !std::isfinite(next[0])) return std::nullopt;
    if (next[0] <= 1) { // the rim is a part of the step away
      const double part = root_between(0, h, [&](double some) { return 1 - problem.step(t, some, v)[0]; });
      v = problem.step(t, part, v);
      t += part;
      draw(t, v, result.meridian);
      break;
    }
    v = next;
    t += h;
  }
  const double scale = std::exp(-t); // of lengths: disc to what was integrated
  result.pressure = pressure / scale;
  for (MeridianPoint& point : result.meridian) {
    point.reference_radius *= disc.radius * scale;
    point.radius *= disc.radius * scale;
    point.height = (point.height + v[2]) * scale;
  }
  result.deflection = v[2] * scale;
  result.volume = v[3] * std::pow(scale, 3);
  result.apex_tension = tension;
  result.pole_stretch = pole_stretch;
  return result;
}

std::vector<InflatedCircle> limit_points(const CircularDisc& disc, double last) {
  constexpr double growth = 1.05;
  double sign = 1; // a maximum is next, or a minimum
  const auto value = [&](double stretch) {
    const auto circle = inflate_to(disc, stretch);
    return circle ? sign * circle->pressure : std::nan("");
  };
  std::vector<InflatedCircle> points;
  double low = 1 + 1e-3, middle = growth, high = growth * growth;
  double at_low = value(low), at_middle = value(middle), at_high = value(high);
  while (high < last) {
    if (at_middle > at_low && at_middle > at_high) {
      // golden section: the pressure is flat there, half the digits of the stretch give all of its
      const double golden = 0.5 * (std::sqrt(5.0) - 1);
      double a = low, b = high;
      double x = b - golden * (b - a), y = a + golden * (b - a);
      double at_x = value(x), at_y = value(y);
      while (b - a > 1e-5 * b) {
        if (at_x > at_y) {
          b = y;
          y = x;
          at_y = at_x;
          x = b - golden * (b - a);
          at_x = value(x);
        } else {
          a = x;
          x = y;
          at_x = at_y;
          y = a + golden * (b - a);
          at_y = value(y);
        }
      }
      points.push_back(inflate_to(disc, 0.5 * (a + b)).value());
      sign = -sign;
      at_middle = -at_middle;
      at_high = -at_high;
    }
    low = middle;
    at_low = at_middle;
    middle = high;
    at_middle = at_high;
    high *= growth;
    at_high = value(high);
  }
  return points;
}

std::optional<InflatedCircle> inflate_closed(const CircularMembrane& membrane, double absolute0, double volume0,
                                             double kappa, double ambient, double external, int steps) {
  // Net pressure p on the membrane: inside gauge pressure less external. Find p with (p + external + ambient)
  // V(p)^kappa = absolute0 volume0^kappa; the left side grows with p.
  const auto miss = [&](const InflatedCircle& circle) {
    return std::log((circle.pressure + external + ambient) / absolute0) + kappa * std::log(circle.volume / volume0);
  };
  double low = 1e-3 * (absolute0 - ambient), high = absolute0 - ambient;
  std::optional<InflatedCircle> at;
  for (int i = 0; i < 60; ++i) {
    at = inflate(membrane, high, steps);
    if (!at) return std::nullopt;
    if (miss(*at) > 0) break;
    low = high;
    high *= 1.5;
  }
  std::optional<InflatedCircle> below = inflate(membrane, low, steps);
  for (int i = 0; i < 6 && below && miss(*below) > 0; ++i) { // the volume goes to 0 with the pressure: a root is below
    low *= 0.01;
    below = inflate(membrane, low, steps);
  }
  if (!below || miss(*below) > 0) return std::nullopt;
  return inflate(membrane,
                 root_between(low, high,
                              [&](double p) {
                                const std::optional<InflatedCircle> circle = inflate(membrane, p, steps);
                                return circle ? miss(*circle) : std::nan("");
                              }),
                 steps);
}

} // namespace pneuma::solver::analytical
