// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/base/quantities.h"
#include "geometry/mesh.h"
#include "geometry/outline.h"
#include "geometry/quadrature.h"
#include "pipeline/schema/node.h"

// What a workflow file says, checked and in SI units: the contract of spec `workflow.md` as plain data. Both the runner
// and the stages read it; `stage.yaml`, which the runner writes for each stage, carries the same keys with all defaults
// filled in.
namespace pneuma::pipeline::workflow {

using base::Vec3;

using schema::Mark;      // where a value stands in the user's file
using schema::Problem;   // one thing wrong there
using schema::to_string; // "cushion.yaml:14:22"

struct Site {
  base::AbsolutePressure ambient_pressure{101325};
  double temperature = 296.15; // K
  Vec3 up{0, 0, 1};
  bool gravity = true;
};

struct ElasticLaw {
  double E = 0;  // Pa
  double nu = 0; // -
};

// Incompressible, W = C1 (I1 - 3) + C2 (I2 - 3); neo-Hooke is C2 = 0.
struct MooneyRivlinLaw {
  double C1 = 0, C2 = 0; // Pa
};

// A resolved material. Laws that the schema knows and the solver does not are refused when read.
struct Material {
  std::string name;
  std::variant<ElasticLaw, MooneyRivlinLaw> law;
  bool tension_field = false;              // cannot carry compression
  std::optional<double> density;           // kg/m3
  std::optional<double> thermal_expansion; // 1/K
  std::string source;
  Mark mark;
};

struct FoilSettings {
  std::string name;
  std::string material;
  double thickness = 0; // m
  double warp = 0;      // rad
  Mark mark;
};

struct ChamberSettings {
  std::string name;
  std::string outer, inner; // foil names; inner may be "base"
  double dead_volume = 0;   // m3
  std::string connected_to; // chamber whose air it shares, which is not itself connected; empty: an air of its own
  Mark mark;
};

struct Cushion {
  geometry::Plan plan;
  std::map<std::string, std::string> edges; // every edge name -> clamped (others refused when read, for now)
  std::vector<FoilSettings> foils;          // from the weather side inwards
  bool rigid_base = false;
  std::vector<ChamberSettings> chambers;
  Mark mark;
};

enum class MeshPattern : std::uint8_t { automatic, structured, unstructured };

struct MeshSettings {
  geometry::ElementType element = geometry::ElementType::T6;
  std::optional<double> size; // m
  std::optional<std::array<int, 2>> divisions;
  MeshPattern pattern = MeshPattern::automatic;
  geometry::StressRule stress_rule = geometry::StressRule::full;
  Mark mark;
};

struct SolverOptions {
  std::optional<double> tolerance; // relative residual
  std::optional<int> max_iterations;
  std::optional<int> max_steps; // of inflate and wind
};

struct FormfindSettings {
  std::map<std::string, double> gauge_pressure; // chamber -> Pa, every chamber present
  std::map<std::string, double> prestress;      // foil -> N/m, every foil present (`stress` already times thickness)
};

struct LoadControl {};

struct DisplacementControl {
  std::optional<base::Vec2> at; // m, in plan; none: the largest displacement of the foil
  std::string foil;
  Vec3 direction{0, 0, 0}; // of the controlled displacement, unit length; zero: the site's up (meaningless for max)
  double until = 0;        // m, not zero; its sign counts along the direction
};

struct VolumeControl {
  std::string chamber;
  double until = 0; // m3
};

// Ends at the first of these that is reached; at least one is given.
struct ArcLengthControl {
  std::optional<double> load_factor, pressure, volume, displacement; // -, Pa (gauge), m3, m
  std::optional<double> after_peak;                                  // the load fell to this part of its peak, 0 .. 1
  std::string chamber; // of pressure and volume; filled in where there is only one; empty: neither is given
  std::string foil;    // of displacement (largest); empty: of all foils
};

// How the path is followed.
// What part of a stage's load acts when, s.
struct Moment {
  double time = 0;
  double factor = 0;
};

struct Control {
  std::variant<LoadControl, DisplacementControl, VolumeControl, ArcLengthControl> kind;
  std::optional<int>
      steps; // output at n equal parts of the path (of each stretch between two moments); none: automatic
  std::vector<Moment> schedule; // of load control, from nothing at 0 s, linear between; empty: no time passes
};

enum class Reference : std::uint8_t { prestressed, stress_free };

struct InflateSettings {
  std::map<std::string, double> gauge_pressure; // chamber -> Pa
  std::optional<Reference> reference;           // required from a formfind stage
  std::map<std::string, double> prestress;      // foil -> N/m; only from `mesh`; empty: stress-free
  bool contact_stops = true;
  Control control;
};

enum class CuttingLines : std::uint8_t { geodesic, straight };
enum class ChosenBy : std::uint8_t { distortion, waste };

// Width of the film as bought; selvedge: not used along both its edges; weld: width of the overlap, m.
struct Roll {
  double width = 1.55, weld = 0.012, selvedge = 0.01;
};

// How much smaller than the form the strips are cut, so that they stretch to it.
struct Compensation {
  enum class Kind : std::uint8_t { none, elastic, given } kind = Kind::none;
  double warp = 0, weft = 0; // given: flat length = (1 - value) x length on the form
  double creep = 0;          // beside the elastic strain, in both directions
};

using PlanCurves = std::vector<std::vector<base::Vec2>>; // m

struct PatternSettings {
  // what decides the layout: a number of strips, the roll (the fewest strips that fit), or given curves
  std::optional<int> strips_per_foil;
  Roll roll;
  bool roll_given = false;                  // then every strip must fit on it
  std::map<std::string, PlanCurves> curves; // foil -> curves in plan
  CuttingLines lines = CuttingLines::geodesic;
  std::optional<double> direction; // rad, of the strips' length from the plan's x axis; none: auto
  ChosenBy chosen_by = ChosenBy::distortion;
  Compensation compensation;
  double decompensation = 0;      // m, width of the zone along clamped edges where the compensation fades in; 0: none
  std::vector<std::string> foils; // to be cut; empty: all that are not flat
  double clamp_allowance = 0.03;  // m
  double notch_spacing = 0.5;     // m
};

struct RegulatedGas {
  std::optional<double> gauge_pressure; // Pa; none: as in the `from` state
};
struct ClosedGas {
  double kappa = 1;
  std::optional<double> temperature;      // K, at the end; none: as in the `from` state
  std::optional<double> ambient_pressure; // Pa absolute, at the end; none: as in the `from` state
};
struct VolumeGas {
  double volume = 0; // m3
};
using Gas = std::variant<RegulatedGas, ClosedGas, VolumeGas>;

struct PlanBox {
  std::array<double, 2> x, y; // m
};
using PlanPolygon = std::vector<base::Vec2>;                       // m
using Region = std::variant<std::monostate, PlanBox, PlanPolygon>; // monostate: all of the foil

struct WindLoad {
  double pressure = 0; // Pa, positive pushes against the face it acts on
};
struct SnowLoad {
  double weight = 0; // Pa, per plan area of the `from` state
};
struct PatchLoad {
  base::Vec2 center, size; // m
  Vec3 force;              // N
};

struct Load {
  std::string name;
  std::string foil;
  std::variant<WindLoad, SnowLoad, PatchLoad> kind;
  Region region;
  double factor = 1;
  Mark mark;
};

struct WindSettings {
  std::map<std::string, Gas> gas; // chamber -> law, every chamber present that is not connected to another
  std::vector<Load> loads;
  bool contact_stops = true;
  Control control;
};

struct StageSettings {
  std::string id;
  std::string run;      // mesh, formfind, pattern, inflate, wind
  std::string from;     // stage id; empty for mesh
  std::string from_run; // kind of the stage it starts from
  std::variant<MeshSettings, FormfindSettings, PatternSettings, InflateSettings, WindSettings> settings;
  SolverOptions options;
  Mark mark;
};

// A whole workflow file, or (read from stage.yaml) the part of it that one stage needs: then `stages` has one entry.
struct Workflow {
  std::filesystem::path file;
  std::string name;
  Site site;
  Cushion cushion;
  std::map<std::string, Material> materials; // those the foils use
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

// Reads the stage.yaml that the runner wrote (or a user edited); marks of values point to the user's own file where
// stage.yaml says where they came from. Throws InputError with all problems, a line each.
Workflow read_stage(const std::filesystem::path& file);

// The text of stage.yaml for one stage: effective values of the stage, the cushion, the used materials, the site, and
// the place each value came from. The same workflow gives the same bytes; no absolute path and no time enters.
std::string stage_yaml(const Workflow& workflow, const StageSettings& stage);

// The same without the places: equal texts mean equal settings, however the user's file is laid out.
std::string effective_settings(const Workflow& workflow, const StageSettings& stage);

} // namespace pneuma::pipeline::workflow
