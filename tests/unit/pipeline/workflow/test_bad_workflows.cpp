// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/unit/pipeline/workflow/messages.h"

namespace pneuma::pipeline::workflow {
namespace {

class BadWorkflow : public testing::TestWithParam<Bad> {};

TEST_P(BadWorkflow, IsToldWhatAndWhere) {
  const Bad& bad = GetParam();
  expect_messages(bad.before, bad.after, bad.messages);
}

constexpr const char* rectangle = "{shape: rectangle, length: 6 m, width: 3 m}";
constexpr const char* foil = "{name: upper, material: etfe, thickness: 250 um}";
constexpr const char* mesh = "mesh: {element: T6, size: 0.15 m}";
constexpr const char* form =
    "{run: formfind, from: mesh, gauge_pressure: {top: 400 Pa, bottom: 400 Pa}, prestress: {all: 0.89 kN/m}}";
constexpr const char* inflated =
    "{run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: prestressed}";
constexpr const char* load = "{name: suction, foil: upper, wind: -0.6 kPa}";

const Bad cases[] = {
    {"UnknownKey",
     "thickness: 250 um",
     "@thicknes: 250 um, thickness: 250 um",
     {"unknown key `thicknes` in entry 1 of `foils`; did you mean `thickness`?; known: name, material, thickness, "
      "warp"}},
    {"UnknownKeyAtTheTop",
     "name: Test cushion",
     "@nmae: Test cushion",
     {"unknown key `nmae` in the file; did you mean `name`?"}},
    {"MissingKey", foil, "@{name: upper, material: etfe}", {"entry 1 of `foils` lacks the key `thickness`"}},
    {"DuplicateKey",
     mesh,
     "mesh: {element: T6, size: 0.15 m, @size: 0.2 m}",
     {"the key `size` stands here a second time"}},
    {"DuplicateStage", "  inflated:", "  @form: {}\n  inflated:", {"the key `form` stands here a second time"}},
    {"WrongDimension",
     "thickness: 250 um",
     "thickness: @250 kPa",
     {"`250 kPa` has a unit of another kind; expected a length"}},
    {"UnknownUnit", "thickness: 250 um", "thickness: @250 mikron", {"has the unknown unit `mikron`"}},
    {"BareNumber",
     "thickness: 250 um",
     "thickness: @0.00025",
     {"`thickness`: `0.00025` has no unit; expected a length such as `250 um`"}},
    {"BareNumberInThePlan", "width: 3 m", "width: @3", {"`width`: `3` has no unit; expected a length such as `6 m`"}},
    {"BareNumberOfAStress",
     "law: elastic, E: 900 MPa",
     "law: elastic, E: @900",
     {"`E`: `900` has no unit; expected a pressure or stress such as `900 MPa`"}},
    {"ThousandsSeparator", "E: 900 MPa", "E: @1'000 MPa", {"did you mean `1000 MPa`?"}},
    {"DecimalCommaInBraces",
     "thickness: 250 um",
     "thickness: @0,25 mm",
     {"`thickness`: `0,25 mm` has a decimal comma; did you mean `0.25 mm`?"}},
    {"DecimalCommaInAList",
     "{shape: rectangle, length: 6 m, width: 3 m}",
     "{shape: polygon, points: [[0 m, 0 m], [2 m, @1,5 m], [0 m, 2 m]]}",
     {"`1,5 m` has a decimal comma; did you mean `1.5 m`?"}},
    {"DecimalComma", "thickness: 250 um", "thickness: @\"0,25 mm\"", {"decimal comma"}},
    {"NoNumber", "size: 0.15 m", "size: @small", {"`small` does not begin with a number"}},
    {"Reciprocal", "size: 0.15 m", "size: @5 1/m", {"`5 1/m` has a unit of another kind"}},
    {"Coulomb", "cushion:\n", "site: {temperature: @23 C}\ncushion:\n", {"the unit of temperature is degC or K"}},
    {"UnitOnANumber", "nu: 0.45", "nu: @0.45 m", {"`nu` must be a plain number, not `0.45 m`"}},
    {"NegativeThickness", "thickness: 250 um", "thickness: @-250 um", {"`thickness` must be positive, not -250 um"}},
    {"PoissonsRatioOutOfRange", "nu: 0.45", "nu: @0.6", {"`nu` must be above -1, up to 0.5, not 0.6"}},
    {"ZeroYoungsModulus", "E: 900 MPa", "E: @0 MPa", {"`E` must be positive, not 0 MPa"}},
    {"UnknownMaterial",
     foil,
     "{name: upper, material: @etef, thickness: 250 um}",
     {"there is no material `etef`; did you mean `etfe`?; materials: etfe"}},
    {"MissingMaterialsFile",
     "materials:\n  etfe: {law: elastic, E: 900 MPa, nu: 0.45, density: 1750 kg/m3}\n",
     "materials: @nowhere.yaml\n",
     {"nowhere.yaml` cannot be read: No such file or directory"}},
    {"DuplicateFoil",
     "thickness: 200 um}",
     "thickness: 200 um}\n    - {name: @upper, material: etfe, thickness: 1 mm}",
     {"a second foil `upper`: every foil needs a name of its own"}},
    {"ReservedFoilName",
     "thickness: 200 um}",
     "thickness: 200 um}\n    - {name: @all, material: etfe, thickness: 1 mm}",
     {"a foil cannot be called `all`"}},
    {"UnknownFoilOfAChamber",
     "[upper, middle]",
     "[@uper, middle]",
     {"there is no foil `uper`; did you mean `upper`?; foils: upper, middle, lower"}},
    {"ChamberBetweenNoNeighbours",
     "[upper, middle]",
     "@[upper, lower]",
     {"`upper` and `lower` are no neighbours; from the weather side inwards: upper, middle, lower"}},
    {"TwoChambersInOneGap",
     "[middle, lower]",
     "@[middle, upper]",
     {"between these foils lies the chamber `top` already"}},
    {"ChamberToAMissingBase", "[middle, lower]", "[lower, @base]", {"the cushion has no base; say `base: rigid`"}},
    {"ChamberWithThreeWalls", "[upper, middle]", "@[upper, middle, lower]", {"`between` must have 2 entries, not 3"}},
    {"DuplicateChamber",
     "between: [middle, lower]}",
     "between: [middle, lower]}\n    - {name: @top, between: [lower, base]}\n  base: rigid",
     {"a second chamber `top`: every chamber needs a name of its own"}},
    {"ConnectedToItself",
     "between: [middle, lower]}",
     "between: [middle, lower], connected_to: @bottom}",
     {"`bottom` cannot be connected to itself"}},
    {"ConnectedToAnUnknownChamber",
     "between: [middle, lower]}",
     "between: [middle, lower], connected_to: @tpo}",
     {"there is no chamber `tpo`; did you mean `top`?; chambers: top, bottom"}},
    {"ConnectedToAConnectedChamber",
     "between: [middle, lower]}",
     "between: [middle, lower], connected_to: top}\n    - {name: third, between: [lower, base], connected_to: "
     "@bottom}\n  base: rigid",
     {"`bottom` is itself connected to `top`; connect both to `top`"}},
    {"ConnectedToEachOther",
     "between: [upper, middle]}\n    - {name: bottom, between: [middle, lower]}",
     "between: [upper, middle], connected_to: @bottom}\n    - {name: bottom, between: [middle, lower], connected_to: "
     "@top}",
     {"`bottom` is connected to `top` in turn; say it at one of the two",
      "`top` is connected to `bottom` in turn; say it at one of the two"}},
    {"UnknownEdge",
     "{all: clamped}",
     "{all: clamped, @suoth: clamped}",
     {"there is no edge `suoth`; did you mean `south`?; edges: south, east, north, west"}},
    {"FreeEdge",
     "{all: clamped}",
     "{south: @free}",
     {"`south`: `free` is not available yet; clamped edges are available"}},
    {"UnknownShape",
     "shape: rectangle",
     "shape: @rectangel",
     {"`shape` must be one of: rectangle, circle, triangle, polygon, not `rectangel`; did you mean `rectangle`?"}},
    {"RegularPolygonPlan",
     "{shape: rectangle, length: 6 m, width: 3 m}",
     "{shape: @regular_polygon, sides: 6, radius: 2 m}",
     {"`shape`: `regular_polygon` is not available yet; rectangle, circle, triangle and polygon are available"}},
    {"PolygonWithoutPoints",
     rectangle,
     "@{shape: polygon}",
     {"`plan` lacks the key `points`: corners in order, either way round (a list [...])"}},
    {"PolygonOfTwoPoints",
     rectangle,
     "{shape: polygon, points: @[[0 m, 0 m], [1 m, 1 m]]}",
     {"`points` must have at least 3 entries, not 2"}},
    {"PolygonPointWithoutUnit",
     rectangle,
     "{shape: polygon, points: [[0 m, 0 m], [1 m, @1], [2 m, 5 m]]}",
     {"`1` has no unit; expected a length"}},
    {"PolygonPointInSpace",
     rectangle,
     "{shape: polygon, points: [[0 m, 0 m], @[1 m, 1 m, 0 m], [2 m, 5 m]]}",
     {"entry 2 of `points` must have 2 entries, not 3"}},
    {"PolygonThatCrossesItself",
     rectangle,
     "{shape: polygon, points: @[[0 m, 0 m], [2 m, 0 m], [0 m, 2 m], [2 m, 2 m]]}",
     {"the outline crosses or touches itself: its edges e2 from (2, 0) and e4 from (2, 2) meet"}},
    {"PolygonWithARepeatedPoint",
     rectangle,
     "{shape: polygon, points: @[[0 m, 0 m], [2 m, 0 m], [200 cm, 0 m], [2 m, 2 m]]}",
     {"the edge e2 has no length: the points 2 and 3 are the same, (2, 0); leave one out"}},
    {"PolygonWithoutArea",
     rectangle,
     "{shape: polygon, points: @[[0 m, 0 m], [1 m, 1 m], [2 m, 2 m]]}",
     {"the points of the outline lie on a line, or nearly so"}},
    {"UnknownEdgeOfAPolygon",
     "{shape: rectangle, length: 6 m, width: 3 m}\n  edges: {all: clamped}\n",
     "{shape: polygon, points: [[0 m, 0 m], [2 m, 0 m], [2 m, 2 m], [0 m, 1 m]]}\n  edges: {e1: clamped, @e5: "
     "clamped}\n",
     {"there is no edge `e5`; did you mean `e1`?; edges: e1, e2, e3, e4"}},
    {"TriangleWithoutSize",
     "{shape: rectangle, length: 6 m, width: 3 m}",
     "@{shape: triangle}",
     {"`plan` needs exactly one of: side, points; it has none"}},
    {"FlatTriangle",
     "{shape: rectangle, length: 6 m, width: 3 m}",
     "{shape: triangle, points: @[[0 m, 0 m], [1 m, 1 m], [2 m, 2 m]]}",
     {"the points of the outline lie on a line, or nearly so"}},
    {"SizeAndDivisions",
     mesh,
     "mesh: @{size: 0.15 m, divisions: 4}",
     {"`mesh` needs exactly one of: size, divisions; it has 2"}},
    {"NeitherSizeNorDivisions",
     mesh,
     "mesh: @{element: T6}",
     {"`mesh` needs exactly one of: size, divisions; it has none"}},
    {"FractionalDivisions", mesh, "mesh: {divisions: @4.5}", {"`divisions` must be a whole number, not `4.5`"}},
    {"NoDivisions", mesh, "mesh: {divisions: [4, @0]}", {"entry 2 of `divisions` must be from 1 to 10000, not 0"}},
    {"ReducedRuleOnT6",
     mesh,
     "mesh: {element: T6, size: 0.15 m, stress_rule: @reduced}",
     {"the reduced rule is for Q9, not T6; allowed: full"}},
    {"UnknownElement",
     "element: T6",
     "element: @T7",
     {"`element` must be one of: T3, T6, Q4, Q9, not `T7`; did you mean `T3`?"}},
    {"UnknownStageInFrom",
     "from: form",
     "from: @from",
     {"there is no stage `from`; did you mean `form`?; stages: mesh, form, gust"}},
    {"Circle",
     form,
     "{run: formfind, from: @gust, gauge_pressure: {top: 400 Pa, bottom: 400 Pa}, prestress: {all: 0.89 kN/m}}",
     {"`from` goes in a circle: form <- gust <- inflated <- form"}},
    {"StageCalledMesh",
     "  inflated:",
     "  @mesh: {run: wind, from: inflated, gas: {top: {law: volume, volume: 9 m3}}}\n  inflated:",
     {"a stage cannot be called `mesh`"}},
    {"WindFromMesh",
     "from: inflated",
     "from: @mesh",
     {"`run: wind` cannot start from `mesh` (`run: mesh`); it starts from: inflate, wind"}},
    {"FactorOfNoLoadBefore",
     "  gust:",
     "  later: {run: wind, from: more, factors: {suction: 0, extra: 2, @sucton: 1}}\n"
     "  more: {run: wind, from: gust, loads: [{name: extra, foil: upper, snow: 1 kPa}]}\n  gust:",
     {"there is no load `sucton`; did you mean `suction`?; loads: extra, suction"}},
    {"LoadOfTheSameNameBefore",
     "  gust:",
     "  later: {run: wind, from: more, loads: [@{name: suction, foil: upper, snow: 1 kPa}]}\n"
     "  more: {run: wind, from: gust, factors: {suction: 0}}\n  gust:",
     {"load `suction` acts since stage `gust`: to change it give its factor in `factors`, or choose another name"}},
    {"FormfindFromInflate",
     form,
     "{run: formfind, from: mesh, gauge_pressure: {top: 400 Pa, bottom: 400 Pa}, prestress: {all: 0.89 kN/m}}\n"
     "  again: {run: formfind, from: @inflated, gauge_pressure: {top: 400 Pa, bottom: 400 Pa}, prestress: {all: 0.89 "
     "kN/m}}",
     {"`run: formfind` cannot start from `inflated` (`run: inflate`); it starts from: mesh"}},
    {"PatternFromMesh",
     "  gust:",
     "  strips: {run: pattern, from: @mesh, strips_per_foil: 6}\n  gust:",
     {"`run: pattern` cannot start from `mesh` (`run: mesh`); it starts from: formfind"}},
    {"WindFromPattern",
     "from: inflated",
     "from: @strips\n    gas: {bottom: {law: volume, volume: 9 m3}}\n  strips: {run: pattern, from: form, "
     "strips_per_foil: 6}\n  other:\n    "
     "run: wind\n    from: "
     "inflated",
     {"`run: wind` cannot start from `strips` (`run: pattern`); it starts from: inflate"}},
    {"ReferenceAndPrestressFromPattern",
     inflated,
     "{run: inflate, from: strips, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, @reference: stress_free, "
     "@prestress: {all: 1 kN/m}}\n  strips: {run: pattern, from: form, strips_per_foil: 6}",
     {"`reference` cannot stand beside a start from a pattern stage: the flat strips are the reference; leave it out",
      "`prestress` cannot stand beside a start from a pattern stage: the flat strips are the reference"}},
    {"PatternOfNothing",
     "  gust:",
     "  strips: @{run: pattern, from: form}\n  gust:",
     {"`strips` needs at least one of: strips_per_foil, roll, curves; it has none"}},
    {"UnknownRun",
     "run: wind",
     "run: @wnid",
     {"`run` must be one of: formfind, pattern, inflate, wind, not `wnid`; did you mean `wind`?"}},
    {"InflateWithoutReference",
     inflated,
     "@{run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}}",
     {"from a formfind stage, `reference` must say what the found form is: prestressed or stress_free"}},
    {"PrestressFromAFoundForm",
     inflated,
     "{run: inflate, from: form, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, reference: stress_free, @prestress: "
     "{all: 1 kN/m}}",
     {"`prestress` is for a start from mesh"}},
    {"ReferenceFromMesh",
     inflated,
     "{run: inflate, from: mesh, gauge_pressure: {top: 400 Pa, bottom: 300 Pa}, @reference: prestressed}",
     {"`reference` is for a start from a formfind stage"}},
    {"PrestressAndStress",
     form,
     "@{run: formfind, from: mesh, gauge_pressure: {top: 400 Pa, bottom: 400 Pa}, prestress: {all: 1 kN/m}, stress: "
     "{all: 4 MPa}}",
     {"`form` needs exactly one of: prestress, stress, sag, volume; it has 2"}},
    {"SagTarget",
     form,
     "{run: formfind, from: mesh, gauge_pressure: {top: 400 Pa, bottom: 400 Pa}, @sag: {all: 0.3 m}}",
     {"`sag` is not available yet; an isotropic prestress (or stress) per foil is available"}},
    {"WarpAndWeft",
     "{all: 0.89 kN/m}",
     "{all: @{warp: 1 kN/m, weft: 2 kN/m}}",
     {"`all` as a map is not available yet; an isotropic prestress"}},
    {"FoilWithoutPrestress",
     "{all: 0.89 kN/m}",
     "@{upper: 1 kN/m, lower: 1 kN/m}",
     {"`prestress` says nothing about the foil `middle`; name it, or use `all`"}},
    {"PrestressOfAnUnknownFoil",
     "{all: 0.89 kN/m}",
     "{all: 1 kN/m, @lwoer: 2 kN/m}",
     {"there is no foil `lwoer`; did you mean `lower`?"}},
    {"PrestressOfAMisspeltAll",
     "{all: 0.89 kN/m}",
     "{@allx: 0.89 kN/m}",
     {"there is no foil `allx`; foils: upper, middle, lower"}},
    {"PressureOfAnUnknownChamber",
     "{top: 400 Pa, bottom: 400 Pa}",
     "{top: 400 Pa, bottom: 400 Pa, @buttom: 1 Pa}",
     {"there is no chamber `buttom`; did you mean `bottom`?; chambers: top, bottom"}},
    {"ChamberWithoutPressure",
     "{top: 400 Pa, bottom: 400 Pa}",
     "@{top: 400 Pa}",
     {"`gauge_pressure` says nothing about the chamber `bottom`"}},
    {"WindOnAMiddleFoil",
     load,
     "{name: suction, foil: @middle, wind: -0.6 kPa}",
     {"wind cannot reach the middle foil `middle`; it acts on the first or the last: upper, lower"}},
    {"LoadOnAnUnknownFoil",
     load,
     "{name: suction, foil: @uper, wind: -0.6 kPa}",
     {"there is no foil `uper`; did you mean `upper`?"}},
    {"LoadOfTwoKinds",
     load,
     "@{name: suction, foil: upper, wind: -0.6 kPa, snow: 1 kPa}",
     {"needs exactly one of: wind, snow, patch; it has 2"}},
    {"EmptyRegion",
     load,
     "{name: suction, foil: upper, wind: -0.6 kPa, region: {x: @[1 m, 0 m], y: [0 m, 1 m]}}",
     {"the first end must be below the second"}},
    {"RegionPolygonOfTwoCorners",
     load,
     "{name: suction, foil: upper, wind: -0.6 kPa, region: {polygon: @[[0 m, 0 m], [1 m, 0 m]]}}",
     {"`polygon` must have at least 3 entries, not 2"}},
    {"FactorOfAnUnknownLoad",
     "    loads:",
     "    factors: {@suctoin: 2}\n    loads:",
     {"there is no load `suctoin`; did you mean `suction`?"}},
    {"GasOfAnUnknownChamber", "gas: {top:", "gas: {@tpo:", {"there is no chamber `tpo`; did you mean `top`?"}},
    {"TemperatureWithKappa",
     "kappa: 1.4}",
     "kappa: 1.4, @temperature: 30 degC}",
     {"`temperature` is for kappa 1: otherwise the gas law itself sets it; leave it out"}},
    {"UnknownGasLaw",
     "law: closed",
     "law: @close",
     {"`law` must be one of: regulated, closed, volume, not `close`; did you mean `closed`?"}},
    {"DurationAndHistory",
     "  gust:\n    run: wind\n",
     "  gust:\n    @duration: 5 s\n    history: [{time: 5 s, factor: 1}]\n    run: wind\n",
     {"`gust` needs at most one of: duration, history; it has 2"}},
    {"NoDuration", "    loads:", "    duration: @0 s\n    loads:", {"`duration` must be positive, not 0 s"}},
    {"TimeGoesBack",
     "    loads:",
     "    history: [{time: 5 s, factor: 1}, @{time: 3 s, factor: 0}]\n    loads:",
     {"time goes back: 3 s after 5 s"}},
    {"NothingHappens",
     "    loads:",
     "    history: [{time: 5 s, factor: 1}, @{time: 5 s, factor: 1}]\n    loads:",
     {"neither time nor factor change"}},
    {"TimeOnAPathOfVolume",
     "    loads:",
     "    control: {type: displacement, foil: upper, until: 1 m}\n    @duration: 5 s\n    loads:",
     {"`duration` is for load control"}},
    {"Combinations",
     "stages:\n",
     "@combinations: {a: {from: inflated}}\nstages:\n",
     {"`combinations` is not available yet"}},
    {"Accuracy", "stages:\n", "@accuracy: {deflection: 1 %}\nstages:\n", {"`accuracy` is not available yet"}},
    {"UnknownLaw",
     "law: elastic",
     "law: @mooney",
     {"`law` must be one of: elastic, j2, ogden, mooney_rivlin, neo_hooke, pd_nurbs, le_nurbs, not `mooney`"}},
    {"MooneyRivlinWithoutC2",
     "{law: elastic, E: 900 MPa, nu: 0.45,",
     "@{law: mooney_rivlin, C1: 25 MPa,",
     {"`etfe` lacks the key `C2`: of W (a pressure or stress with its unit)"}},
    {"ZeroC1",
     "{law: elastic, E: 900 MPa, nu: 0.45,",
     "{law: mooney_rivlin, C1: @0 MPa, C2: 7 MPa,",
     {"`C1` must be positive, not 0 MPa"}},
    {"NegativeC2",
     "{law: elastic, E: 900 MPa, nu: 0.45,",
     "{law: mooney_rivlin, C1: 25 MPa, C2: @-7 MPa,",
     {"`C2` must be at least 0 Pa, not -7 MPa"}},
    {"C2OfNeoHooke",
     "{law: elastic, E: 900 MPa, nu: 0.45,",
     "{law: neo_hooke, C1: 25 MPa, @C2: 7 MPa,",
     {"unknown key `C2` in `etfe`"}},
    {"PoissonsRatioOfMooneyRivlin",
     "{law: elastic, E: 900 MPa, nu: 0.45,",
     "{law: mooney_rivlin, C1: 25 MPa, C2: 7 MPa, @nu: 0.5,",
     {"unknown key `nu` in `etfe`"}},
    {"TensionFieldThatIsNoFlag",
     "nu: 0.45",
     "nu: 0.45, tension_field: @wrinkles",
     {"`tension_field` must be on or off, not `wrinkles`"}},
    {"GravityWithoutDensity",
     ", density: 1750 kg/m3}\ncushion:\n  plan: {shape: rectangle, length: 6 m, width: 3 m}\n  edges: {all: clamped}\n "
     " foils:\n"
     "    - {name: upper, material: etfe",
     "}\ncushion:\n  plan: {shape: rectangle, length: 6 m, width: 3 m}\n  edges: {all: clamped}\n  foils:\n"
     "    - {name: upper, material: @etfe",
     {"the material `etfe` has no `density`, which gravity needs; add it, or say `site: {gravity: off}`"}},
    {"VersionOfTheFormat", "pneuma: 1", "pneuma: @2", {"`pneuma` must be 1, the version this program reads, not 2"}},
    {"Nothing", "name: Test cushion", "@name:", {"`name` must be a text, not nothing"}},
    {"ListForAMap",
     mesh,
     "mesh: @[T6]",
     {"`mesh` must be a map with the keys element, size, divisions, pattern, stress_rule, not a list"}},
    {"FlagThatIsNone",
     "cushion:\n",
     "site: {gravity: @maybe}\ncushion:\n",
     {"`gravity` must be on or off, not `maybe`"}},
    {"ZeroUp", "cushion:\n", "site: {up: @[0, 0, 0]}\ncushion:\n", {"`up` must not be zero"}},
    {"StageIdWithABlank", "  gust:", "  @my gust:", {"`my gust` is no name: letters, digits, _ and - are allowed"}},
    {"Tolerance",
     "    loads:",
     "    options: {tolerance: @2}\n    loads:",
     {"`tolerance` must be between 0 and 1, not 2"}},
    {"NoSteps",
     "    loads:",
     "    options: {max_steps: @0}\n    loads:",
     {"`max_steps` must be from 1 to 100000, not 0"}},
    {"HalfAStep",
     "    loads:",
     "    options: {max_steps: @1.5}\n    loads:",
     {"`max_steps` must be a whole number, not `1.5`"}},
    {"StepsOfFormfinding",
     "prestress: {all: 0.89 kN/m}",
     "prestress: {all: 0.89 kN/m}, options: {@max_steps: 3}",
     {"unknown key `max_steps` in `options`; known: tolerance, max_iterations"}},
    {"AllAtOnce",
     "thickness: 250 um}\n    - {name: middle, material: etfe, thickness: 100 um}",
     "thickness: @250 kPa}\n    - {name: middle, material: @etff, @colour: red, thickness: @-1 mm}",
     {"has a unit of another kind", "there is no material `etff`", "unknown key `colour`", "must be positive"}},
};

TEST(BadPolygonMesh, IsToldWhatIsAllowed) {
  const std::string polygon =
      replaced(example, rectangle, "{shape: polygon, points: [[0 m, 0 m], [2 m, 0 m], [2 m, 2 m], [0 m, 1 m]]}");
  const Folder folder;
  const auto message = [&](const char* keys) {
    const ReadResult result = read_workflow(folder.write("w.yaml", replaced(polygon, mesh, keys)));
    return result.problems.size() == 1 ? result.problems[0].message : "no problem, or several";
  };
  EXPECT_EQ(message("mesh: {size: 0.15 m, pattern: structured}"),
            "a polygon has no structured pattern; allowed: unstructured");
  EXPECT_EQ(message("mesh: {divisions: [6, 4]}"), "a polygon has one number of `divisions`, along its longest side");
}

// Keys of a stage of the example, and the messages.
struct BadKeys {
  const char* claim;
  const char* keys;
  std::vector<const char*> messages;
};

const BadKeys pattern_cases[] = {
    {"UnknownKey",
     "@strips_per_fol: 6, roll: {width: 1.5 m, weld: 12 mm, selvedge: 10 mm}",
     {"unknown key `strips_per_fol` in `strips`; did you mean `strips_per_foil`?"}},
    {"OneStrip", "strips_per_foil: @1", {"`strips_per_foil` must be from 2 to 200, not 1"}},
    {"NegativeStrips", "strips_per_foil: @-3", {"`strips_per_foil` must be from 2 to 200, not -3"}},
    {"HalfAStrip", "strips_per_foil: @2.5", {"`strips_per_foil` must be a whole number, not `2.5`"}},
    {"RollWithoutSelvedge",
     "roll: @{width: 1.5 m, weld: 12 mm}",
     {"`roll` lacks the key `selvedge`: not used along both edges (a length with its unit)"}},
    {"RollWithoutWeld", "roll: @{width: 1.5 m, selvedge: 1 cm}", {"`roll` lacks the key `weld`"}},
    {"RollWithoutWidth", "roll: @{weld: 12 mm, selvedge: 1 cm}", {"`roll` lacks the key `width`"}},
    {"RollOfNoWidth", "roll: {width: @0 m, weld: 12 mm, selvedge: 1 cm}", {"`width` must be positive, not 0 m"}},
    {"NegativeWeld",
     "roll: {width: 1.5 m, weld: @-12 mm, selvedge: 1 cm}",
     {"`weld` must be at least 0 m, not -12 mm"}},
    {"NegativeSelvedge",
     "roll: {width: 1.5 m, weld: 12 mm, selvedge: @-1 cm}",
     {"`selvedge` must be at least 0 m, not -1 cm"}},
    {"RollEatenUp",
     "roll: @{width: 1 m, weld: 10 mm, selvedge: 495 mm}",
     {"the `weld` and two times the `selvedge` (1 m) leave nothing of the `width` 1 m"}},
    {"StripsAndCurves",
     "strips_per_foil: 6, curves: {all: [[[0 m, -1.5 m], [0 m, 1.5 m]]]}",
     {"`strips` needs at most one of: strips_per_foil, curves; it has 2"}},
    {"CurvesOfAnUnknownFoil",
     "curves: {all: [[[0 m, -1.5 m], [0 m, 1.5 m]]], @uper: [[[0 m, -1.5 m], [0 m, 1.5 m]]]}",
     {"there is no foil `uper`; did you mean `upper`?"}},
    {"CurvesOfNoFoil", "curves: @{}", {"`curves` is empty; it needs a map from names to values"}},
    {"NoCurve", "curves: {all: @[]}", {"`all` must have at least 1 entries, not 0"}},
    {"CurveOfOnePoint", "curves: {all: [@[[0 m, -1.5 m]]]}", {"entry 1 of `all` must have at least 2 entries, not 1"}},
    {"PointInSpace",
     "curves: {all: [[@[0 m, 1 m, 2 m], [1 m, 1 m]]]}",
     {"entry 1 of entry 1 of `all` must have 2 entries, not 3"}},
    {"PointWithoutUnit", "curves: {all: [[[@0, 1 m], [1 m, 1 m]]]}", {"`0` has no unit; expected a length"}},
    {"CurvesLackAFoilToBeCut",
     "foils: [upper, lower], curves: @{upper: [[[0 m, -1.5 m], [0 m, 1.5 m]]]}",
     {"`curves` says nothing about the foil `lower` of `foils`; name it, or use `all`"}},
    {"CurvesOfAFoilNotToBeCut",
     "foils: [lower], curves: {all: [[[0 m, -1.5 m], [0 m, 1.5 m]]], @upper: [[[0 m, -1.5 m], [0 m, 1.5 m]]]}",
     {"`foils` does not name `upper`, so its curves have no effect; foils to be cut: lower"}},
    {"LinesBesideCurves",
     "curves: {all: [[[0 m, -1.5 m], [0 m, 1.5 m]]]}, @lines: straight, @direction: auto, @chosen_by: waste",
     {"`lines` has no effect beside `curves`, which are the seams themselves; leave it out",
      "`direction` has no effect beside `curves`", "`chosen_by` has no effect beside `curves`"}},
    {"UnknownLines",
     "strips_per_foil: 6, lines: @geodetic",
     {"`lines` must be one of: geodesic, straight, not `geodetic`; did you mean `geodesic`?"}},
    {"UnknownDirection",
     "strips_per_foil: 6, direction: @atuo",
     {"`direction` must be auto or an angle with its unit, not `atuo`; did you mean `auto`?"}},
    {"DirectionWithoutUnit",
     "strips_per_foil: 6, direction: @30",
     {"`direction`: `30` has no unit; expected an angle such as `30 deg`"}},
    {"DirectionOfAnotherKind",
     "strips_per_foil: 6, direction: @30 m",
     {"`30 m` has a unit of another kind; expected an angle"}},
    {"DirectionAsAVector",
     "strips_per_foil: 6, direction: @[1, 0]",
     {"`direction` must be auto or an angle with its unit, not a list"}},
    {"ChosenByBesideADirection",
     "strips_per_foil: 6, direction: 30 deg, @chosen_by: waste",
     {"`chosen_by` has no effect beside `curves` or a given `direction`: it chooses among directions; leave it out"}},
    {"UnknownChoice",
     "strips_per_foil: 6, chosen_by: @wast",
     {"`chosen_by` must be one of: distortion, waste, not `wast`; did you mean `waste`?"}},
    {"UnknownCompensation",
     "strips_per_foil: 6, compensation: @elastisch",
     {"`compensation` must be one of: none, elastic or a map with the keys warp, weft, not `elastisch`; did you mean "
      "`elastic`?"}},
    {"HalfACompensation",
     "strips_per_foil: 6, compensation: @{warp: 0.3 %}",
     {"`compensation` lacks the key `weft`: across the roll (a ratio with its unit)"}},
    {"CompensationWithoutUnit",
     "strips_per_foil: 6, compensation: {warp: @0.3, weft: 0.2 %}",
     {"`warp`: `0.3` has no unit; expected a ratio such as `0.3 %`"}},
    {"NegativeCompensation",
     "strips_per_foil: 6, compensation: {warp: 0.3 %, weft: @-0.2 %}",
     {"`weft` must be at least 0 % and below 50 %, not -0.2 %"}},
    {"CompensationOfHalfTheFoil",
     "strips_per_foil: 6, compensation: {warp: @50 %, weft: 0.2 %}",
     {"`warp` must be at least 0 % and below 50 %, not 50 %"}},
    {"CreepWithoutCompensation",
     "strips_per_foil: 6, @creep: 0.1 %",
     {"`creep` is for `compensation: elastic`, to which it is added; leave it out"}},
    {"CreepBesideAGivenCompensation",
     "strips_per_foil: 6, compensation: {warp: 0.3 %, weft: 0.2 %}, @creep: 0.1 %",
     {"`creep` is for `compensation: elastic`"}},
    {"CreepOfHalfTheFoil",
     "strips_per_foil: 6, compensation: elastic, creep: @51 %",
     {"`creep` must be at least 0 % and below 50 %, not 51 %"}},
    {"DecompensationOfNothing",
     "strips_per_foil: 6, @decompensation: 0.3 m",
     {"`decompensation` is for `compensation: elastic` or {warp: ..., weft: ...}, which it lets fade in; leave it"}},
    {"NegativeDecompensation",
     "strips_per_foil: 6, compensation: elastic, decompensation: @-0.3 m",
     {"`decompensation` must be at least 0 m, not -0.3 m"}},
    {"UnknownFoilToBeCut",
     "strips_per_foil: 6, foils: [upper, @lwoer]",
     {"there is no foil `lwoer`; did you mean `lower`?; foils: upper, middle, lower"}},
    {"FoilToBeCutTwice",
     "strips_per_foil: 6, foils: [upper, lower, @upper]",
     {"the foil `upper` stands here a second time"}},
    {"NoFoilToBeCut", "strips_per_foil: 6, foils: @[]", {"`foils` must have at least 1 entries, not 0"}},
    {"UnknownAllowance",
     "strips_per_foil: 6, allowance: {@clmap: 30 mm}",
     {"unknown key `clmap` in `allowance`; did you mean `clamp`?; known: clamp, notches"}},
    {"NegativeAllowance",
     "strips_per_foil: 6, allowance: {clamp: @-30 mm}",
     {"`clamp` must be at least 0 m, not -30 mm"}},
    {"NotchesWithoutDistance",
     "strips_per_foil: 6, allowance: {notches: @0 m}",
     {"`notches` must be positive, not 0 m"}},
    {"Control", "strips_per_foil: 6, @contact: stop", {"unknown key `contact` in `strips`"}},
};

std::ostream& operator<<(std::ostream& out, const BadKeys& bad) {
  return out << bad.claim;
}

class BadPattern : public testing::TestWithParam<BadKeys> {};

TEST_P(BadPattern, IsToldWhatAndWhere) {
  const BadKeys& bad = GetParam();
  const std::string stage = std::string("{run: pattern, from: form, ") + bad.keys + "}";
  const bool is_about_the_stage = std::string(bad.keys).find('@') == std::string::npos;
  expect_messages(
      "  gust:", "  strips: " + std::string(is_about_the_stage ? "@" : "") + stage + "\n  gust:", bad.messages);
}

INSTANTIATE_TEST_SUITE_P(Cases, BadPattern, testing::ValuesIn(pattern_cases),
                         [](const auto& used) { return std::string(used.param.claim); });

// What stands behind `control:` in the wind stage of the example, whose upper chamber is closed.
const BadKeys control_cases[] = {
    {"UnknownWord",
     "@lood",
     {"`control` must be load or a map with the key `type` (one of: load, displacement, volume, arc_length), "
      "not `lood`; did you mean `load`?"}},
    {"DisplacementInAWord", "@displacement", {"`control` must be load or a map with the key `type`"}},
    {"NoType", "@{steps: 3}", {"`control` lacks the key `type`: one of load, displacement, volume, arc_length"}},
    {"UnknownType",
     "{type: @arclength}",
     {"`type` must be one of: load, displacement, volume, arc_length, not `arclength`; did you mean `arc_length`?"}},
    {"KeyOfAnotherType", "{type: load, @until: 1 m}", {"unknown key `until` in `control`"}},
    {"NoParts", "{type: load, steps: @0}", {"`steps` must be from 1 to 100000, not 0"}},
    {"DisplacementWithoutEnd",
     "@{type: displacement, foil: upper}",
     {"`control` lacks the key `until`: the displacement in the end; its sign counts along the direction (a length "
      "with its unit)"}},
    {"DisplacementOfAnotherKind",
     "{type: displacement, foil: upper, until: @0.1 m3}",
     {"`0.1 m3` has a unit of another kind; expected a length"}},
    {"NoDisplacement", "{type: displacement, at: [0 m, 0 m], foil: upper, until: @0 m}", {"`until` must not be zero"}},
    {"LargestDisplacementWithSign",
     "{type: displacement, at: max, foil: upper, until: @-0.1 m}",
     {"`until` must be positive, not -0.1 m: the largest displacement (`at: max`) has no sign"}},
    {"DirectionOfTheLargest",
     "{type: displacement, foil: upper, @direction: [0, 0, 1], until: 0.1 m}",
     {"`direction` is for a displacement at a place, not the largest (`at: max`); leave it out"}},
    {"ZeroDirection",
     "{type: displacement, at: [0 m, 0 m], foil: upper, direction: @[0, 0, 0], until: 0.1 m}",
     {"`direction` must not be zero"}},
    {"DirectionInPlan",
     "{type: displacement, at: [0 m, 0 m], foil: upper, direction: @[1, 0], until: 0.1 m}",
     {"`direction` must have 3 entries, not 2"}},
    {"PlaceInSpace",
     "{type: displacement, at: @[0 m, 0 m, 0 m], foil: upper, until: 0.1 m}",
     {"`at` must have 2 entries, not 3"}},
    {"UnknownPlace",
     "{type: displacement, at: @apex, foil: upper, until: 0.1 m}",
     {"`at` must be max or a list [...], not `apex`"}},
    {"DisplacementOfNoFoil",
     "@{type: displacement, until: 0.1 m}",
     {"`control` lacks the key `foil`; foils: upper, middle, lower"}},
    {"DisplacementOfAnUnknownFoil",
     "{type: displacement, foil: @uper, until: 0.1 m}",
     {"there is no foil `uper`; did you mean `upper`?; foils: upper, middle, lower"}},
    {"VolumeOfNoChamber", "@{type: volume, until: 5 m3}", {"`control` lacks the key `chamber`; chambers: top, bottom"}},
    {"VolumeOfAnUnknownChamber",
     "{type: volume, chamber: @buttom, until: 5 m3}",
     {"there is no chamber `buttom`; did you mean `bottom`?; chambers: top, bottom"}},
    {"NegativeVolume", "{type: volume, chamber: bottom, until: @-5 m3}", {"`until` must be positive, not -5 m3"}},
    {"VolumeOfClosedAir",
     "{type: volume, chamber: @top, until: 5 m3}",
     {"the volume of `top` cannot be controlled: its gas (`law: closed`) decides it; allowed: regulated"}},
    {"ArcWithoutEnd",
     "@{type: arc_length}",
     {"`control` lacks the key `until`: the path ends at the first that is reached"}},
    {"ArcUntilNothing",
     "{type: arc_length, until: @{}}",
     {"`until` needs at least one of: load_factor, pressure, volume, displacement, after_peak; it has none"}},
    {"ArcUntilAQuantity",
     "{type: arc_length, until: @0.1 m}",
     {"`until` must be a map with the keys load_factor, pressure, volume, displacement, after_peak, not `0.1 m`"}},
    {"ZeroLoadFactor", "{type: arc_length, until: {load_factor: @0}}", {"`load_factor` must be positive, not 0"}},
    {"AfterPeakInPercent",
     "{type: arc_length, until: {after_peak: @50}}",
     {"`after_peak` must be between 0 and 1, not 50"}},
    {"NegativeLargestDisplacement",
     "{type: arc_length, until: {displacement: @-1 m}}",
     {"`displacement` must be positive, not -1 m"}},
    {"ArcUntilThePressureOfNoChamber",
     "@{type: arc_length, until: {pressure: 1 kPa}}",
     {"`control` lacks the key `chamber`; chambers: top, bottom"}},
    {"ArcUntilThePressureOfAnUnknownChamber",
     "{type: arc_length, until: {pressure: 1 kPa}, chamber: @tpo}",
     {"there is no chamber `tpo`; did you mean `top`?"}},
    {"ArcOfAnUnknownFoil",
     "{type: arc_length, until: {displacement: 1 m}, foil: @lwoer}",
     {"there is no foil `lwoer`; did you mean `lower`?"}},
    {"ArcWithChamberAndFoilForNothing",
     "{type: arc_length, until: {load_factor: 1}, @chamber: top, @foil: upper}",
     {"`chamber` is for `until: {pressure: ...}` or `{volume: ...}`; leave it out",
      "`foil` is for `until: {displacement: ...}`; leave it out"}},
};

class BadControl : public testing::TestWithParam<BadKeys> {};

TEST_P(BadControl, IsToldWhatAndWhere) {
  const BadKeys& bad = GetParam();
  expect_messages("    loads:", "    control: " + std::string(bad.keys) + "\n    loads:", bad.messages);
}

TEST(BadControl, VolumeOfAPrescribedVolumeIsToldWhatDecidesIt) {
  const Folder folder;
  const std::string text =
      replaced(example, "law: closed, kappa: 1.4}}",
               "law: volume, volume: 4 m3}}\n    control: {type: volume, chamber: top, until: 5 m3}");
  const ReadResult result = read_workflow(folder.write("w.yaml", text));
  ASSERT_EQ(result.problems.size(), 1U);
  EXPECT_EQ(result.problems[0].message,
            "the volume of `top` cannot be controlled: its gas (`law: volume`) decides it; allowed: regulated");
}

INSTANTIATE_TEST_SUITE_P(Cases, BadControl, testing::ValuesIn(control_cases),
                         [](const auto& used) { return std::string(used.param.claim); });

// The example with the lower chamber connected to the upper one.
std::string connected() {
  return replaced(example, "between: [middle, lower]}", "between: [middle, lower], connected_to: top}");
}

TEST(ConnectedChamber, HasNoOtherPressureThanTheOneItIsConnectedTo) {
  const Folder folder;
  const ReadResult result = read_workflow(folder.write("w.yaml", connected()));
  ASSERT_EQ(result.problems.size(), 1U);
  EXPECT_THAT(to_string(result.problems[0]),
              testing::EndsWith("w.yaml:18:78: `bottom` is connected to `top` and has its pressure, 400 "
                                "Pa, not 300 Pa; leave it out"));
}

TEST(ConnectedChamber, DoesNotStateThePressureInsteadOfTheOneItIsConnectedTo) {
  const Folder folder;
  const std::string text = replaced(replaced(connected(), "bottom: 300 Pa", "bottom: 400 Pa"),
                                    "{top: 400 Pa, bottom: 400 Pa}", "{bottom: 400 Pa}");
  const ReadResult result = read_workflow(folder.write("w.yaml", text));
  ASSERT_EQ(result.problems.size(), 1U);
  EXPECT_THAT(to_string(result.problems[0]),
              testing::EndsWith("w.yaml:17:53: `gauge_pressure` says nothing about the chamber `top`; `bottom` is "
                                "connected to it and takes its pressure"));
}

TEST(ConnectedChamber, HasNoGasOfItsOwnInAWindStage) {
  const Folder folder;
  const std::string text =
      replaced(replaced(connected(), "bottom: 300 Pa", "bottom: 400 Pa"), "gas: {top: {law: closed, kappa: 1.4}}",
               "gas: {top: {law: closed, kappa: 1.4}, bottom: {law: closed}}");
  const ReadResult result = read_workflow(folder.write("w.yaml", text));
  ASSERT_EQ(result.problems.size(), 1U);
  EXPECT_TRUE(
      testing::Value(to_string(result.problems[0]),
                     testing::EndsWith("w.yaml:22:43: `bottom` is connected to `top` and has no air of its own; "
                                       "say the law of `top`")))
      << to_string(result.problems[0]);
}

TEST(ConnectedChamber, HasNoVolumeToControlWhereTheSharedAirIsClosed) {
  const Folder folder;
  const std::string text =
      replaced(replaced(connected(), "bottom: 300 Pa", "bottom: 400 Pa"),
               "    loads:", "    control: {type: volume, chamber: bottom, until: 5 m3}\n    loads:");
  const ReadResult result = read_workflow(folder.write("w.yaml", text));
  ASSERT_EQ(result.problems.size(), 1U);
  EXPECT_EQ(result.problems[0].message,
            "the volume of `top` cannot be controlled: its gas (`law: closed`) decides it; allowed: regulated");
}

INSTANTIATE_TEST_SUITE_P(Cases, BadWorkflow, testing::ValuesIn(cases),
                         [](const auto& used) { return std::string(used.param.claim); });

} // namespace
} // namespace pneuma::pipeline::workflow
