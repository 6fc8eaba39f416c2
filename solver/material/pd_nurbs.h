// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>

#include "solver/material/nurbs_table.h"
#include "solver/material/principal.h"

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
    const PrincipalStrain e = principal_strain(strain);
    return !table->domain.holds(e.first, e.second);
  }

  Status evaluate(const Vec3& strain, const double*, double*, double, Response& response) const noexcept {
    const PrincipalStrain e = principal_strain(strain);
    if (!(e.second > -0.5) || !std::isfinite(e.first)) return Status::failed;
    if (!continued && !table->domain.holds(e.first, e.second)) return Status::outside_data;
    PrincipalFunction f;
    response.energy = 0;
    if (table->yield) f = table->yield->stress(e, response.energy);
    if (table->potential) add_surfaces(e, 0.5 * (strain[0] + strain[1]), f, response.energy);
    response.potential = response.energy;
    in_frame(e, f, response.stress, response.tangent);
    return Status::ok;
  }

  double thickness_stretch(const Vec3& strain, const double*) const noexcept {
    return thickness_of_area(strain, poissons_ratio);
  }

  Vec3 stress_free_strain(const double*) const noexcept { return Vec3::Zero(); }

private:
  void add_surfaces(const PrincipalStrain& e, double mean, PrincipalFunction& sum, double& energy) const noexcept {
    double w = 0;
    PrincipalFunction f = of_surfaces(e.first, e.second, w);
    if (e.difference > table->near) {
      f.quotient = (f.s1 - f.s2) / e.difference;
    } else {
      // the mean over the difference of a derivative that is even in it: exact for parabolas
      double unused = 0;
      f.quotient = (2 * turning(of_surfaces(mean, mean, unused)) + turning(f)) / 3;
      const double mean_stress = 0.5 * (f.s1 + f.s2);
      f.s1 = mean_stress + 0.5 * f.quotient * e.difference;
      f.s2 = mean_stress - 0.5 * f.quotient * e.difference;
    }
    sum.s1 += f.s1;
    sum.s2 += f.s2;
    sum.d11 += f.d11;
    sum.d12 += f.d12;
    sum.d21 += f.d21;
    sum.d22 += f.d22;
    sum.quotient += f.quotient;
    energy += w;
  }

  // d (s1 - s2) / d (E1 - E2)
  static double turning(const PrincipalFunction& f) noexcept { return 0.5 * (f.d11 - f.d12 - f.d21 + f.d22); }

  // Without the quotient.
  PrincipalFunction of_surfaces(double e1, double e2, double& energy) const noexcept {
    const geometry::nurbs::SurfaceJet<1> w = geometry::nurbs::evaluate(*table->potential, e1, e2);
    energy = w.value[0];
    if (!table->stress) return {w.u[0], w.v[0], w.uu[0], w.uv[0], w.uv[0], w.vv[0]};
    const geometry::nurbs::SurfaceJet<1> first = geometry::nurbs::evaluate(*table->stress, e1, e2);
    const geometry::nurbs::SurfaceJet<1> second = geometry::nurbs::evaluate(*table->stress, e2, e1);
    return {first.value[0], second.value[0], first.u[0], first.v[0], second.v[0], second.u[0]};
  }
};
static_assert(Material<PdNurbs>);

} // namespace pneuma::solver::material
