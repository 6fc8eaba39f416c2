// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>

#include "solver/material/nurbs_table.h"

namespace pneuma::solver::material {

// LE-NURBS: elastic, S11(E11, E22), S22(E11, E22) and S12(2 E12) from tables along material axes (Coelho 2012,
// sec. 4.2), by default the derivatives of one potential W(E11, E22) + w(2 E12); from stress surfaces of their own the
// tangent is not symmetric, and the energy that of the nearest potential. Shear and stretches do not feel each other:
// the law depends on the direction of its axes even where the material it was fitted to does not.
// Strain outside the data: Status::outside_data, or where asked for the stress goes on linearly (`continued`).
// Thickness as of PD-NURBS.
struct LeNurbs {
  static constexpr auto history_names = no_history;

  std::shared_ptr<const LeTable> table;
  bool continued = false;
  double poissons_ratio = 0.5;

  bool outside(const Vec3& strain) const noexcept {
    return !(table->domain.holds(strain[0], strain[1]) &&
             std::abs(strain[2]) <= table->shear.knots.last() + table_rounding);
  }

  Status evaluate(const Vec3& strain, const double*, double*, double, Response& response) const noexcept {
    const double c1 = 1 + 2 * strain[0];
    const double c2 = 1 + 2 * strain[1];
    if (!(std::min(c1, c2) > 0 && c1 * c2 > strain[2] * strain[2])) return Status::failed;
    if (!continued && outside(strain)) return Status::outside_data;
    const geometry::nurbs::SurfaceJet<1> w = geometry::nurbs::evaluate(table->potential, strain[0], strain[1]);
    const geometry::nurbs::CurveJet<1> shear = geometry::nurbs::evaluate(table->shear, strain[2]);
    response.energy = response.potential = w.value[0] + shear.value[0];
    if (table->first) {
      const geometry::nurbs::SurfaceJet<1> first = geometry::nurbs::evaluate(*table->first, strain[0], strain[1]);
      const geometry::nurbs::SurfaceJet<1> second = geometry::nurbs::evaluate(*table->second, strain[0], strain[1]);
      response.stress = Vec3(first.value[0], second.value[0], shear.first[0]);
      response.tangent << first.u[0], first.v[0], 0, second.u[0], second.v[0], 0, 0, 0, shear.second[0];
    } else {
      response.stress = Vec3(w.u[0], w.v[0], shear.first[0]);
      response.tangent << w.uu[0], w.uv[0], 0, w.uv[0], w.vv[0], 0, 0, 0, shear.second[0];
    }
    return Status::ok;
  }

  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    return thickness_of_area(strain, poissons_ratio);
  }

  Vec3 stress_free_strain(const double*) const noexcept { return Vec3::Zero(); }
};
static_assert(Material<LeNurbs>);

} // namespace pneuma::solver::material
