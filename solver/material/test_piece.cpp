// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/test_piece.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

namespace pneuma::solver::material {

namespace {

// sqrt(1 + 2 E) - 1 without loss of digits
double fibre_strain(double green_lagrange) {
  return 2 * green_lagrange / (1 + std::sqrt(1 + 2 * green_lagrange));
}

double fibre_stretch(double green_lagrange) {
  return std::sqrt(1 + 2 * green_lagrange);
}

Vec3 held_by(const Control& control, const PieceState& state) {
  return control.strain * state.engineering_strain() + control.stress * state.nominal_stress();
}

// d held / d strain
Mat3 slope_of(const Control& control, const PieceState& state) {
  const double a = fibre_stretch(state.strain[0]);
  const double b = fibre_stretch(state.strain[1]);
  Mat3 nominal = Vec3(a, b, 1).asDiagonal() * state.tangent;
  nominal(0, 0) += state.stress[0] / a;
  nominal(1, 1) += state.stress[1] / b;
  return control.strain * Vec3(1 / a, 1 / b, 1).asDiagonal() + control.stress * nominal;
}

// The smallest solution of slope * x = right: a slack tension field leaves rows without a say. Rows are in units of
// their own.
Vec3 smallest_solution(Mat3 slope, Vec3 right) {
  for (int i = 0; i < 3; ++i) {
    const double size = slope.row(i).norm();
    if (size == 0) continue;
    slope.row(i) /= size;
    right[i] /= size;
  }
  Eigen::CompleteOrthogonalDecomposition<Mat3> decomposition;
  decomposition.setThreshold(1e-13);
  return decomposition.compute(slope).solve(right);
}

} // namespace

Control uniaxial() {
  return biaxial(1, 0);
}

Control biaxial(double a, double b) {
  Control control;
  const int driven = std::abs(b) > std::abs(a) ? 1 : 0;
  control.strain(0, driven) = 1;
  control.stress.row(1) = Vec3(-b, a, 0);
  control.stress(2, 2) = 1;
  return control;
}

Control wide_strip() {
  Control control;
  control.strain(0, 0) = control.strain(1, 1) = 1;
  control.stress(2, 2) = 1;
  return control;
}

Control shear() {
  Control control;
  control.strain(2, 2) = 1;
  control.stress(0, 0) = control.stress(1, 1) = 1;
  control.direction = Vec3::UnitZ();
  return control;
}

Control strains(const Vec3& direction) {
  return {Mat3::Identity(), Mat3::Zero(), direction};
}

Control stresses(const Vec3& direction) {
  return {Mat3::Zero(), Mat3::Identity(), direction};
}

Vec3 PieceState::engineering_strain() const {
  return {fibre_strain(strain[0]), fibre_strain(strain[1]), strain[2]};
}

Vec3 PieceState::nominal_stress() const {
  return {fibre_stretch(strain[0]) * stress[0], fibre_stretch(strain[1]) * stress[1], stress[2]};
}

Vec3 PieceState::logarithmic_strain() const {
  return {0.5 * std::log1p(2 * strain[0]), 0.5 * std::log1p(2 * strain[1]), strain[2]};
}

Vec3 PieceState::true_stress() const {
  const double a = fibre_stretch(strain[0]);
  const double b = fibre_stretch(strain[1]);
  return {stress[0] * a / (b * thickness_stretch), stress[1] * b / (a * thickness_stretch), 0};
}

TestPiece::TestPiece(const Law& law, double angle) : law_(law) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  to_material_ << c * c, s * s, -c * s, s * s, c * c, c * s, 2 * c * s, -2 * c * s, c * c - s * s;
  state_.history.assign(static_cast<std::size_t>(history_components(law)), 0.0);
  ask(Vec3::Zero(), 0, state_, status_);
  status_ = Status::ok;
}

bool TestPiece::ask(const Vec3& strain, double dt, PieceState& answer, Status& failure) const {
  failure = Status::failed;
  if (!(strain[0] > -0.5 && strain[1] > -0.5 && std::isfinite(strain[2]))) return false;
  Batch batch;
  batch.count = 1;
  batch.strain[0] = to_material_ * strain;
  std::vector<double> history(state_.history.size());
  batch.old_history = state_.history.data();
  batch.new_history = history.data();
  batch.dt = dt;
  if (evaluate(law_, batch) != -1) {
    failure = batch.status;
    return false;
  }
  const Response& response = batch.response[0];
  answer.strain = strain;
  answer.stress = to_material_.transpose() * response.stress;
  answer.tangent = to_material_.transpose() * response.tangent * to_material_;
  answer.energy = response.energy;
  answer.thickness_stretch = thickness_stretch(law_, batch.strain[0], history.data());
  answer.history = std::move(history);
  return answer.stress.allFinite() && answer.tangent.allFinite();
}

// Natural monotonicity (Deuflhard 2004, Newton Methods for Nonlinear Problems, sec. 3.1): steps are compared, in the
// units of strain, not residuals, whose rows have different ones.
bool TestPiece::solve(const Control& control, const Vec3& held, double dt, PieceState& found) {
  if (!ask(state_.strain, dt, found, status_)) return false;
  constexpr int enough = 50;
  constexpr double sharp = 1e-13, rounding = 1e-10; // of the strain: wanted; accepted where no step improves it
  constexpr double small = 1e-6;                    // strain: tables are free of stress at zero only to rounding
  for (int i = 0; i < enough; ++i) {
    const Mat3 slope = slope_of(control, found);
    const Vec3 step = smallest_solution(slope, held - held_by(control, found));
    const double size = step.norm();
    const double scale = std::max({(found.strain + step).norm(), state_.strain.norm(), small});
    PieceState next;
    double part = 1;
    bool better = false;
    for (; part > 1e-3 && !better; part /= 2) {
      if (!ask(found.strain + part * step, dt, next, status_)) continue;
      const double remaining = smallest_solution(slope, held - held_by(control, next)).norm();
      better = remaining <= (1 - 0.25 * part) * size;
    }
    if (!better) return size <= rounding * scale;
    found = std::move(next);
    if (size <= sharp * scale) return true;
  }
  return false;
}

bool TestPiece::advance(const Control& control, double target, double duration) {
  const Vec3 from = held_by(control, state_);
  const Vec3 to = target * control.direction;
  double done = 0;
  double part = 1;
  constexpr double smallest = 1e-6;
  constexpr int enough = 10000; // a law that takes nothing but small parts of the way does not get there
  for (int i = 0; done < 1; ++i) {
    if (i == enough) return false;
    const double next = std::min(1.0, done + part);
    PieceState found;
    if (solve(control, (1 - next) * from + next * to, (next - done) * duration, found)) {
      found.time = state_.time + (next - done) * duration;
      state_ = std::move(found);
      done = next;
      status_ = Status::ok;
      part *= 2;
    } else {
      part /= 2;
      if (part < smallest) return false;
    }
  }
  return true;
}

double TestPiece::driven(const Control& control) const {
  return control.direction.dot(held_by(control, state_)) / control.direction.squaredNorm();
}

} // namespace pneuma::solver::material
