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

// Isotropic, St. Venant-Kirchhoff.
struct ElasticLaw {
  double E = 0;  // Pa
  double nu = 0; // -
};

// 1 along the foil's warp; nu12: narrowing along 2 in tension along 1.
struct OrthotropicLaw {
  double E1 = 0, E2 = 0; // Pa
  double nu12 = 0;       // -
  double G12 = 0;        // Pa
};

// From this yield stress on, up to that of the next branch; Pa.
struct HardeningBranch {
  double stress = 0;
  double modulus = 0; // plastic or tangent, as the law says
};

enum class ModulusKind : std::uint8_t { plastic, tangent }; // d stress / d plastic strain, or d stress / d strain

struct ViscositySettings {
  enum class Model : std::uint8_t { peric, perzyna } model = Model::peric;
  double mu = 0;                   // s
  double epsilon = 1;              // -
  std::optional<double> threshold; // Pa; none: first yield
};

// J2 plasticity, isotropic hardening; viscoplastic with a viscosity.
struct J2Law {
  double E = 0;  // Pa
  double nu = 0; // -
  std::vector<HardeningBranch> hardening;
  ModulusKind modulus = ModulusKind::plastic;
  bool softening = false;  // a branch may fall
  bool logarithmic = true; // large strain; otherwise small strain
  std::optional<ViscositySettings> viscosity;
};

// Incompressible, W = sum mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3).
struct OgdenLaw {
  struct Term {
    double mu = 0;    // Pa
    double alpha = 0; // -
  };
  std::vector<Term> terms;
};

// Incompressible, W = C1 (I1 - 3) + C2 (I2 - 3); neo-Hooke is C2 = 0.
struct MooneyRivlinLaw {
  double C1 = 0, C2 = 0; // Pa
};

// Elastic, from a table that is fitted to test points, to another material, or to points filled up with one: PD-NURBS
// in principal directions (isotropic), LE-NURBS along the foil's axes.
struct TableLaw {
  // Green-Lagrange strains, -; second Piola-Kirchhoff stresses, Pa.
  struct Point {
    double strain_1 = 0, strain_2 = 0, stress_1 = 0, stress_2 = 0, weight = 1;
  };
  struct ShearPoint {
    double strain = 0, stress = 0, weight = 1; // 2 E12; S12, Pa
  };
  enum class Kind : std::uint8_t { pd_nurbs, le_nurbs } kind = Kind::pd_nurbs;
  std::vector<Point> points;
  std::vector<ShearPoint> shear_points; // of le_nurbs
  std::string fit_to;                   // material; empty: none
  std::array<int, 2> net = {25, 25};    // control points of the stress surfaces
  int degree = 3;
  std::optional<std::array<double, 2>> range; // Green-Lagrange strain; none: that of the points
  bool goes_on = false;                       // linearly outside the data; otherwise an error
  bool potential = true;                      // stresses are derivatives of one potential
  std::optional<double> smoothing;            // weight of bends against residuals; none: as the fit chooses
  double nu = 0.5;                            // of the thickness, about which the points say nothing
};

using MaterialLaw = std::variant<ElasticLaw, OrthotropicLaw, J2Law, OgdenLaw, MooneyRivlinLaw, TableLaw>;

// How near the points of a table come to uniaxial stress along axis 1 and along axis 2: the least ratio of the smaller
// to the larger stress of those that are loaded along it, by a quarter of the largest stress at least; infinite without
// such a point. Of a table of principal stresses twice the same.
std::array<double, 2> least_stress_ratios(const TableLaw& law);

// What the points of a table leave open that no law fills, and what to do about it; empty: nothing.
struct MissingTests {
  std::string message;
  bool useless = false; // a table of such points is none
};
MissingTests missing_tests(const TableLaw& law);

// What the report compares stresses with: f_d = characteristic / (product of factors x factor of the temperature).
struct Strength {
  double characteristic = 0;                      // Pa
  std::optional<double> weld, ultimate;           // Pa
  std::map<std::string, double> factors;          // by name, -
  std::vector<std::array<double, 2>> temperature; // K, factor; rising
  std::string source;
};

// A resolved material.
struct Material {
  std::string name;
  MaterialLaw law;                         // at `at`
  double at = 296.15;                      // K
  std::map<double, MaterialLaw> other;     // K -> law at this temperature, of the same kind as `law`
  bool tension_field = false;              // cannot carry compression
  std::optional<double> density;           // kg/m3
  std::optional<double> thermal_expansion; // 1/K
  std::optional<Strength> strength;
  std::string source;
  Mark mark;
};

// Lowest and highest temperature that a material has values for, K; none: it does not depend on the temperature.
std::optional<std::array<double, 2>> temperatures_of(const Material& material);

// The law of a material at a temperature between those of its table, K: each value is linear between neighbours.
MaterialLaw law_at(const Material& material, double temperature);

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
  std::optional<int> max_steps;       // of inflate and wind, and
  std::optional<double> plastic_step; // growth of the equivalent plastic strain in a step
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

// What part of a stage's load acts when, s.
struct Moment {
  double time = 0;
  double factor = 0;
};

// How the path is followed.
struct Control {
  std::variant<LoadControl, DisplacementControl, VolumeControl, ArcLengthControl> kind;
  std::optional<int> steps;     // output at n equal parts of the path, or of each stretch between two moments
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
  std::map<std::string, double> carried; // load that the `from` stage ends with -> factor that it goes to; others stay
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

// The same without the places: equal texts mean equal settings, however the user's file is laid out.
std::string effective_settings(const Workflow& workflow, const StageSettings& stage);

} // namespace pneuma::pipeline::workflow
