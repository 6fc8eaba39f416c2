// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <variant>

#include "solver/material/j2.h"
#include "solver/material/le_nurbs.h"
#include "solver/material/logarithmic.h"
#include "solver/material/mooney_rivlin.h"
#include "solver/material/ogden.h"
#include "solver/material/orthotropic.h"
#include "solver/material/pd_nurbs.h"
#include "solver/material/st_venant_kirchhoff.h"
#include "solver/material/tension_field.h"

namespace pneuma::solver::material {

static_assert(Material<TensionField<StVenantKirchhoff>> && Material<TensionField<MooneyRivlin>>);
static_assert(Material<TensionField<Orthotropic>> && Material<TensionField<Ogden>>);
static_assert(Material<TensionField<J2>> && Material<TensionField<Logarithmic>>);
static_assert(Material<TensionField<PdNurbs>> && Material<TensionField<LeNurbs>>);

using Law = std::variant<StVenantKirchhoff, Orthotropic, MooneyRivlin, Ogden, J2, Logarithmic, PdNurbs, LeNurbs,
                         TensionField<StVenantKirchhoff>, TensionField<Orthotropic>, TensionField<MooneyRivlin>,
                         TensionField<Ogden>, TensionField<J2>, TensionField<Logarithmic>, TensionField<PdNurbs>,
                         TensionField<LeNurbs>>;

std::span<const std::string_view> history_names(const Law& law);
int history_components(const Law& law); // doubles a point

// What the material feels: of laws without a tension field the strain as it is, taut.
Relaxed relaxed(const Law& law, const Vec3& strain, const double* history);

bool has_tension_field(const Law& law);

// Whether its stress is the derivative of a potential, so that its tangent is symmetric: not of tables whose stresses
// were fitted apart.
bool has_potential(const Law& law);

// Whether it flows with time: then it has an equivalent plastic strain.
bool is_rate_dependent(const Law& law);

double thickness_stretch(const Law& law, const Vec3& strain, const double* history);

// Whether the law is a table that has no data where its material is strained so (and answers, if at all, by going on
// linearly), and the strains, principal or along its axes, that it has data between.
bool outside_data(const Law& law, const Vec3& strain, const double* history);
std::optional<StrainRange> data_range(const Law& law);

// Points of several elements that meet their material in one call: one instantiation per law, none per element type.
struct Batch {
  static constexpr int capacity = 64;
  int count = 0;
  std::array<Vec3, capacity> strain;
  std::array<Response, capacity> response;
  const double* old_history = nullptr; // [point][component]
  double* new_history = nullptr;
  double dt = 0;              // s
  Status status = Status::ok; // of the last point evaluated
};

// Evaluates all points; returns the number of the first one whose status is not ok, or -1.
int evaluate(const Law& law, Batch& batch);

} // namespace pneuma::solver::material
