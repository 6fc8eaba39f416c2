// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "solver/path/load_path.h"
#include "stages/common/foil_results.h"
#include "stages/common/stage.h"

namespace pneuma::stages::common {

// Model of the state's foils, chambers and supports: references from the state (which must have them), foils' weight if
// the site has gravity, chambers regulated at the state's pressures throughout. The stage then changes what it drives.
// `weight_from` and `weight_to`: parts of the weight that act at load factors 0 and 1.
solver::assembly::Model make_model(const Start& start, const State& state, double weight_from, double weight_to);

// A load of the stage, or of one before, and the parts of it that act at load factors 0 and 1.
struct DrivenLoad {
  pipeline::state::Load load;
  double from = 0, to = 1;
};

// Puts a load on the model.
void add_load(const DrivenLoad& driven, solver::assembly::Model& model);

// Follows the path of a model and writes everything that a stage of this kind writes: steps, history.csv, state.hdf
// with its digest, summary.json; with --check nothing. Throws Error with exit code 5 where the path does not reach its
// end, after the last good state is written and marked.
struct Drive {
  solver::assembly::Model model;
  State state;                   // what the new state takes over: mesh, foils, supports, chambers
  std::vector<DrivenLoad> loads; // those on the model; what of them acts at the end goes into the new state
  pipeline::workflow::PathSettings path;
  // The load in a unit of its own, where the stage has one: what it is called and its value at load factor 1, SI.
  std::string load_name = "load_factor";
  double load_at_one = 1;
  std::vector<std::string> modelled; // for the summary, beside what all such stages model
  std::vector<std::string> not_modelled;
  // what the stage itself has to say of the end state
  std::function<void(const State& end, const std::vector<FoilResults>& foils, Summary& summary)> report;
};
void run_equilibrium(const Start& start, Drive drive);

} // namespace pneuma::stages::common
