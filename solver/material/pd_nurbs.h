// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>

#include "solver/material/nurbs_table.h"

namespace pneuma::solver::material {

// PD-NURBS: isotropic, elastic, S1(E1, E2) and S2(E1, E2) in principal directions from a table (Coelho 2012, sec. 4.3),
// by default the derivatives of one potential, so that the tangent is symmetric and the energy exists; from a stress
// surface of its own the tangent is not symmetric, and the energy that of the nearest potential.
// Strain outside the data: Status::outside_data, or where asked for the stress goes on linearly (`continued`).
// A table says nothing of the thickness: J^(-nu / (1 - nu)) for an area ratio J, which is linear elasticity for small
// strains; by default the volume stays, as it does in rubber and in plastic flow.
struct PdNurbs {
  static constexpr auto history_names = no_history;

  std::shared_ptr<const PdTable> table;
  bool continued = false;
  double poissons_ratio = 0.5;

  bool outside(const Vec3& strain) const noexcept {
    const double mean = 0.5 * (strain[0] + strain[1]);
    const double radius = std::hypot(0.5 * (strain[0] - strain[1]), 0.5 * strain[2]);
    return !table->domain.holds(mean + radius, mean - radius);
  }

  Status evaluate(const Vec3& strain, const double*, double*, double, Response& response) const noexcept {
    const double mean = 0.5 * (strain[0] + strain[1]);
    const double half = 0.5 * (strain[0] - strain[1]);
    const double shear = 0.5 * strain[2];
    const double radius = std::hypot(half, shear);
    const double e1 = mean + radius;
    const double e2 = mean - radius;
    if (!std::isfinite(radius) || !(e2 > -0.5)) return Status::failed;
    if (!continued && !table->domain.holds(e1, e2)) return Status::outside_data;
    const Principal at = principal(e1, e2);
    response.energy = response.potential = at.energy;
    // S = p I + q dev(E) with p = (S1 + S2)/2, q = (S1 - S2)/(E1 - E2): no directions where the strains are equal
    const double p = 0.5 * (at.s1 + at.s2);
    const double p_mean = 0.5 * (at.d11 + at.d12 + at.d21 + at.d22);
    const double p_radius = 0.5 * (at.d11 - at.d12 + at.d21 - at.d22);
    const double t_mean = 0.5 * (at.d11 + at.d12 - at.d21 - at.d22); // of t = (S1 - S2)/2
    const double t_radius = at.turning();
    double q = t_radius;
    if (e1 - e2 > table->near) {
      q = (at.s1 - at.s2) / (e1 - e2);
    } else if (radius > 0) {
      q = (2 * principal(mean, mean).turning() + t_radius) / 3; // mean over [0, radius] of what is even in it
    }
    const double c = radius > 0 ? half / radius : 1;
    const double s = radius > 0 ? shear / radius : 0;
    response.stress = Vec3(p + q * half, p - q * half, q * shear);
    // by (mean, half, shear), of (p, t c, t s)
    const double excess = t_radius - q;
    Mat3 slope;
    slope << p_mean, p_radius * c, p_radius * s,        //
        t_mean * c, q + excess * c * c, excess * c * s, //
        t_mean * s, excess * c * s, q + excess * s * s;
    const Mat3 half_slope = 0.5 * slope;
    Mat3 by_strain;
    by_strain << half_slope.col(0) + half_slope.col(1), half_slope.col(0) - half_slope.col(1), half_slope.col(2);
    response.tangent << by_strain.row(0) + by_strain.row(1), by_strain.row(0) - by_strain.row(1), by_strain.row(2);
    return Status::ok;
  }

  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    return thickness_of_area(strain, poissons_ratio);
  }

  Vec3 stress_free_strain(const double*) const noexcept { return Vec3::Zero(); }

private:
  struct Principal {
    double energy, s1, s2;
    double d11, d12, d21, d22; // d S1 / d E2 = d12

    // derivative of (S1 - S2)/2 by (E1 - E2)/2
    double turning() const { return 0.5 * (d11 - d12 - d21 + d22); }
  };

  Principal principal(double e1, double e2) const noexcept {
    const geometry::nurbs::SurfaceJet<1> w = geometry::nurbs::evaluate(table->potential, e1, e2);
    if (!table->stress) return {w.value[0], w.u[0], w.v[0], w.uu[0], w.uv[0], w.uv[0], w.vv[0]};
    const geometry::nurbs::SurfaceJet<1> first = geometry::nurbs::evaluate(*table->stress, e1, e2);
    const geometry::nurbs::SurfaceJet<1> second = geometry::nurbs::evaluate(*table->stress, e2, e1);
    return {w.value[0], first.value[0], second.value[0], first.u[0], first.v[0], second.v[0], second.u[0]};
  }
};
static_assert(Material<PdNurbs>);

} // namespace pneuma::solver::material
