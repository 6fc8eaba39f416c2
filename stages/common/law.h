// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/workflow/settings.h"
#include "solver/material/nurbs_fit.h"

namespace pneuma::stages::common {

class Summary;

// A material as the solver takes it, and how its table, if it is one, follows what it was fitted to.
struct MaterialLaw {
  solver::material::Law law;
  std::optional<solver::material::FitReport> fit, shear_fit; // shear: of LE-NURBS
  std::string missing_tests = {};                            // what the points of its table leave open; empty: nothing
  // Of points without a law that fills: test_data::least_stress_ratios, the larger one.
  std::optional<double> least_stress_ratio = {};
};

using MaterialLaws = std::map<std::string, MaterialLaw>; // by the name of the material

// What is wrong, or looks so, with the law of a material (solver/material/judgement.h) at every temperature of its
// table and at `temperature`, K, each with its place in the user's file; what is the same at several once. Fits no
// table.
std::vector<pipeline::workflow::Problem> problems_of_law(const pipeline::workflow::Material& material,
                                                         double temperature);

// Tells each of these once, by place: prints warnings, throws InputError with all errors, a line each.
void tell(std::vector<pipeline::workflow::Problem> problems);

// Judges the laws of these materials and tells what is wrong with them.
void check_laws(const std::map<std::string, pipeline::workflow::Material>& materials, double temperature);

// The law of one of these materials at a temperature, K; its table is fitted, which takes a second or less. Throws
// InputError, with the place in the user's file, where the material has no values for the temperature, its law there
// has faults (all are told) or a table cannot be fitted to its points.
MaterialLaw law_of(const std::map<std::string, pipeline::workflow::Material>& materials, const std::string& name,
                   double temperature);

// Says how the table of a material, if it is one, was fitted.
void say_fit(const std::string& name, const MaterialLaw& made);

// Laws of all foils at the site's temperature, each made once. Says how tables are fitted.
MaterialLaws laws_of(const pipeline::workflow::Workflow& workflow);

// Writes the keys materials.<name>.fit.* of tables, and warnings where one does not rise with the strain
// or its tests leave strains open.
void summarize(const MaterialLaws& laws, Summary& summary);

} // namespace pneuma::stages::common
