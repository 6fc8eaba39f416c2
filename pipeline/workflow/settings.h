// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pipeline/workflow/cushion.h"
#include "pipeline/workflow/inflate.h"
#include "pipeline/workflow/material.h"
#include "pipeline/workflow/mesh.h"
#include "pipeline/workflow/pattern.h"
#include "pipeline/workflow/wind.h"

// What a workflow file says, checked and in SI units: the contract of spec `workflow.md` as plain data. Both the runner
// and the stages read it; `stage.yaml`, which the runner writes for each stage, carries the same keys with all defaults
// filled in.
namespace pneuma::pipeline::workflow {

using yaml::Problem;   // one thing wrong in a user's file
using yaml::to_string; // "cushion.yaml:14:22"

struct StageSettings {
  std::string id;
  std::string run;      // mesh, formfind, pattern, inflate, wind
  std::string from;     // stage id; empty for mesh
  std::string from_run; // kind of the stage it starts from
  std::variant<MeshSettings, FormfindSettings, PatternSettings, InflateSettings, WindSettings> settings;
};

// A whole workflow file, or (read from stage.yaml) the part of it that one stage needs: then `stages` has one entry.
struct Workflow {
  std::filesystem::path file;
  std::string name;
  Site site;
  Cushion cushion;
  std::map<std::string, Material> materials; // those the foils use, and those that their tables are fitted to
  std::vector<StageSettings> stages;         // in the order of the file, `mesh` first

  // Path of keys in stage.yaml ("cushion.foils.0.thickness", "stages.form.prestress.upper") -> where the user wrote the
  // value, the file relative to the folder of the workflow file. Defaults have no entry.
  std::map<std::string, Mark> origins;
};

struct ReadResult {
  Workflow workflow;             // usable only if no problem is an error
  std::vector<Problem> problems; // all of them at once, in the order of the file
};

// Reads and checks a workflow file. Never throws for what the user wrote; every problem is in the result.
ReadResult read_workflow(const std::filesystem::path& file);

// A file of materials on its own.
struct MaterialsResult {
  std::vector<Material> materials;       // those asked for, in the order of the file
  std::vector<std::string> names;        // of all in the file
  std::map<std::string, Material> known; // all without fault: what tables are fitted to is among them
  std::vector<Problem> problems;
};

// Reads the materials of these names (none: all) from a file of materials, the test points of their tables too. A name
// that is not in the file is not found, and no problem. Never throws for what the user wrote.
MaterialsResult read_materials(const std::filesystem::path& file, const std::vector<std::string>& names);

// Reads the stage.yaml that the runner wrote (or a user edited); marks of values point to the user's own file where
// stage.yaml says where they came from. Throws InputError with all problems, a line each.
Workflow read_stage(const std::filesystem::path& file);

// The text of stage.yaml for one stage: effective values of the stage, the cushion, the used materials, the site, and
// the place each value came from. The same workflow gives the same bytes; no absolute path and no time enters.
std::string stage_yaml(const Workflow& workflow, const StageSettings& stage);

// The same without the places and what changes no result (strength, sources, the name): equal texts mean equal
// settings, however the user's file is laid out.
std::string effective_settings(const Workflow& workflow, const StageSettings& stage);

// The JSON schema of workflow files (configs/workflow.schema.json) and the reference of all keys as text.
std::string workflow_json_schema();
std::string workflow_reference();

} // namespace pneuma::pipeline::workflow

// Their keys are compiled once, in rules.cpp.
// clang-format off
#define PNEUMA_DECLARED(DO)                                                                                            \
  DO(Site) DO(Cushion) DO(FoilSettings) DO(ChamberSettings) DO(MeshSettings) DO(SolverOptions) DO(FormfindSettings)    \
  DO(Roll) DO(GivenCompensation) DO(Allowance) DO(PatternSettings) DO(DisplacementControl) DO(VolumeControl)           \
  DO(ArcTargets) DO(ArcLengthControl) DO(Moment) DO(PathOptions) DO(PathSettings) DO(InflateSettings) DO(Region)       \
  DO(PatchLoad) DO(Load) DO(WindSettings) DO(ElasticLaw) DO(OrthotropicLaw) DO(HardeningBranch) DO(ViscositySettings)  \
  DO(J2Law) DO(OgdenLaw) DO(MooneyRivlinLaw) DO(TableLaw) DO(Strength) DO(Material)
// clang-format on

namespace pneuma::pipeline::schema {

#define PNEUMA_EXTERN(T) extern template const Keys<workflow::T>& keys_of<workflow::T>();
PNEUMA_DECLARED(PNEUMA_EXTERN)
#undef PNEUMA_EXTERN

} // namespace pneuma::pipeline::schema
