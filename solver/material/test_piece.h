// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "solver/material/material.h"

namespace pneuma::solver::material {

// What a test machine holds of a homogeneous piece of foil, along two perpendicular axes 1 and 2 of the piece:
//   strain . (e1, e2, 2 E12) + stress . (n1, n2, S12) = driven amount x direction
// e: engineering strain of a fibre along the axis, sqrt(1 + 2 E) - 1, -; n: nominal stress along it, sqrt(1 + 2 E) S,
// Pa: force per area of the virgin cross section where S12 = 0. Three independent conditions, each a row.
struct Control {
  Mat3 strain = Mat3::Zero();
  Mat3 stress = Mat3::Zero();
  Vec3 direction = Vec3::UnitX();
};

// e1 grows, the sides are free.
Control uniaxial();
// n1 : n2 = a : b, not both zero, no S12; driven by the engineering strain along the larger of the two. (1, 1): equal
// biaxial, (1, -1): shear with the principal axes held.
Control biaxial(double a, double b);
// e1 grows, e2 = 0, no S12: pure shear of rubber testing, the plane strain of a wide strip.
Control wide_strip();
// 2 E12 grows, no n1 and n2.
Control shear();
// (e1, e2, 2 E12) in this ratio.
Control strains(const Vec3& direction);
// (n1, n2, S12) in this ratio.
Control stresses(const Vec3& direction);

// What a piece is like; axes of the piece.
struct PieceState {
  Vec3 strain = Vec3::Zero(); // Green-Lagrange (E11, E22, 2 E12), -
  Vec3 stress = Vec3::Zero(); // second Piola-Kirchhoff (S11, S22, S12), Pa
  Mat3 tangent = Mat3::Zero();
  double energy = 0;            // stored per reference volume, J/m3
  double thickness_stretch = 1; // current / nominal
  std::vector<double> history;  // [component]
  double time = 0;              // s

  Vec3 engineering_strain() const; // (e1, e2, 2 E12), -
  Vec3 nominal_stress() const;     // (n1, n2, S12), Pa
  Vec3 logarithmic_strain() const; // of the fibres along the axes; third: 2 E12
  Vec3 true_stress() const;        // Cauchy along the axes where E12 = S12 = 0, Pa; third: none, 0
};

// A homogeneous piece of foil in a test machine: one material point, moved from state to state.
class TestPiece {
public:
  // `angle`: from the material frame to axis 1 of the piece, rad.
  explicit TestPiece(const Law& law, double angle = 0);

  // Brings the driven amount of a control to `target` in `duration` s; all that the control holds runs in a straight
  // line from where it is to where it shall be, so that one control may follow another: loading, then a held stress
  // (creep) or strain (relaxation), then unloading. Damped Newton on the strains with the law's tangent; the way is cut
  // where that fails. One step of the law in time, unless cut: the caller chooses steps that are short enough for it.
  // False: not reached, or in parts too small; the piece is where it came last.
  bool advance(const Control& control, double target, double duration = 0);

  // The driven amount of a control as the piece is now.
  double driven(const Control& control) const;

  const PieceState& state() const { return state_; }

  // ok, or what the law last refused on a way that was not reached: outside_data where a table ends there.
  Status status() const { return status_; }

private:
  // The law's answer at a strain, from the accepted history; axes of the piece.
  bool ask(const Vec3& strain, double dt, PieceState& answer, Status& failure) const;
  bool solve(const Control& control, const Vec3& held, double dt, PieceState& found);

  Law law_;
  Mat3 to_material_; // of strains
  PieceState state_;
  Status status_ = Status::ok;
};

} // namespace pneuma::solver::material
