// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workflow/options.h"

#include "pipeline/schema/json_schema.h"

namespace pneuma::pipeline::workflow {

namespace {

using schema::choice;
using schema::either;
using schema::flag;
using schema::group;
using schema::integer;
using schema::list;
using schema::number;
using schema::Option;
using schema::quantity;
using schema::table;
using schema::text;
using schema::value;
using schema::variant;
using schema::word;

using Options = std::vector<Option>;

Options operator+(Options a, const Options& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Option length(const std::string& name, const std::string& what) {
  return quantity(name, "m", what).positive().usual(0.01, 100, "usually 1 cm to 100 m");
}

Option point(const std::string& name, const std::string& what) {
  return list(name, quantity("coordinate", "m", "coordinate in plan"), what).items(2, 2);
}

Option interval(const std::string& name, const std::string& what) {
  return list(name, quantity("end", "m", "coordinate in plan"), what).items(2, 2);
}

Option vector(const std::string& name, const std::string& what) {
  return list(name, number("component", "component"), what).items(3, 3);
}

Option pressures(const std::string& what) {
  return table("gauge_pressure",
               quantity("CHAMBER", "Pa", "pressure above the still air around")
                   .usual(0, 2000, "cushions hold 200 to 800 Pa, seldom up to 2 kPa"),
               what);
}

Option isotropic_prestress() {
  return quantity("prestress", "N/m", "force per length, the same in all directions")
      .positive()
      .usual(10, 20000, "usually 0.01 to 20 kN/m");
}

Option site() {
  return group("site",
               {quantity("ambient_pressure", "Pa",
                         "absolute pressure of the still air around; 0 Pa gives the thesis' gas law")
                    .at_least(0, "at least 0 Pa")
                    .otherwise("101325 Pa"),
                quantity("temperature", "K", "of air and foil")
                    .positive()
                    .usual(213.15, 353.15, "usually -60 to 80 degC")
                    .otherwise("23 degC"),
                vector("up", "the direction opposite to gravity").otherwise("[0, 0, 1]"),
                flag("gravity", "weight of the foils in inflate and wind; needs `density`").otherwise("on")},
               "where the cushion is")
      .otherwise("{}");
}

Option plan() {
  const char* shapes = "rectangle, circle, triangle and polygon are available";
  return variant("plan", "shape",
                 {group("rectangle", {length("length", "along x").required(), length("width", "along y").required()},
                        "edges south, east, north, west"),
                  group("circle", {length("radius", "of the rim").required()}, "edge rim"),
                  group("triangle",
                        {length("side", "of an equilateral triangle"),
                         list("points", point("corner", "a corner"), "the three corners").items(3, 3)},
                        "edges e1, e2, e3")
                      .exactly_one({"side", "points"}),
                  group("polygon",
                        {list("points", point("corner", "a corner"), "corners in order, either way round")
                             .items(3, 100000)
                             .required()},
                        "edges e1 (from the first point to the second), e2, ...; re-entrant corners are allowed"),
                  group("regular_polygon", {}, "").unavailable(shapes), group("outline", {}, "").unavailable(shapes),
                  group("file", {}, "").unavailable(shapes)},
                 "the clamped outline in z = 0; rectangle and circle are centred on the origin");
}

Option cushion() {
  const char* clamped = "clamped edges are available";
  const Option edge = choice("EDGE",
                             {value("clamped", "held in all directions"), value("welded", "").unavailable(clamped),
                              value("free", "").unavailable(clamped), value("symmetry", "").unavailable(clamped)},
                             "how the edge is held");
  const Option foil =
      group("foil",
            {word("name", "of the foil").required(), word("material", "a name under `materials`").required(),
             quantity("thickness", "m", "as rolled, unstressed")
                 .required()
                 .positive()
                 .usual(1e-5, 1e-3, "foils are 10 um .. 1 mm thick"),
             quantity("warp", "rad", "angle of the warp direction from x").otherwise("0 deg")},
            "a foil");
  const Option chamber = group(
      "chamber",
      {word("name", "of the chamber").required(),
       list("between", word("wall", "a foil, or base"), "the two neighbouring foils around it").items(2, 2).required(),
       quantity("dead_volume", "m3", "air in ducts").at_least(0, "at least 0 m3").otherwise("0 m3"),
       word("connected_to", "another chamber, whose air it shares: one pressure, the sum of the volumes")},
      "a chamber");
  return group("cushion",
               {plan().required(), table("edges", edge, "per named edge or `all`").otherwise("{}"),
                list("foils", foil, "from the weather side inwards").items(1, 16).required(),
                choice("base", {value("rigid", "a flat base through the clamped edge")}, "what the last foil faces"),
                list("chambers", chamber, "the air between neighbouring foils").otherwise("[]")},
               "what is built");
}

Option mesh() {
  return group("mesh",
               {choice("element",
                       {value("T3", "linear triangle"), value("T6", "quadratic triangle"),
                        value("Q4", "linear quadrangle"), value("Q9", "quadratic quadrangle")},
                       "membrane element")
                    .otherwise("T6"),
                length("size", "wanted size of the elements"),
                either("divisions",
                       {integer("n", "in both directions").between(1, 10000, "from 1 to 10000"),
                        list("pair", integer("n", "in one direction").between(1, 10000, "from 1 to 10000"),
                             "along length and width")
                            .items(2, 2)},
                       "number of elements along the edges"),
                choice("pattern", {value("structured", "regular"), value("unstructured", "free")},
                       "of the mesh; without it structured where the plan allows"),
                choice("stress_rule",
                       {value("full", "T3 1, T6 3, Q4 2x2, Q9 3x3 points"), value("reduced", "2x2 points, Q9 only")},
                       "integration points of the stresses")
                    .otherwise("full")},
               "the mesh all foils get")
      .exactly_one({"size", "divisions"});
}

Option solver_options(const Options& more = {}) {
  return group("options",
               Options{number("tolerance", "relative residual at which an equilibrium is accepted")
                           .within({0, 1, "between 0 and 1", false, false}),
                       integer("max_iterations", "per step").between(1, 1000000, "from 1 to 1000000")} +
                   more,
               "of the solver")
      .otherwise("{}");
}

Option path_options() {
  return solver_options(
      {integer("max_steps",
               "after so many the path is given up; without it after 500, under load control as many as it takes")
           .between(1, 100000, "from 1 to 100000"),
       number("plastic_step", "the most that the equivalent plastic strain of a yielding foil grows in a step")
           .within({0, 1, "above 0, up to 1", false, true})
           .otherwise("0.02")});
}

Option control() {
  const Option steps = integer("steps", "output at n equal parts of the path").between(1, 100000, "from 1 to 100000");
  const Option chamber = word("chamber", "where there are several");
  const Option foil = word("foil", "where there are several");
  const Option place = either("at",
                              {choice("largest", {value("max", "the largest displacement of the foil")}, "not a place"),
                               point("place", "a point of the foil, in plan")},
                              "what is controlled")
                           .otherwise("max");
  const Option targets = group("until",
                               {number("load_factor", "1: everything that the stage states").positive(),
                                quantity("pressure", "Pa", "gauge pressure of the chamber"),
                                quantity("volume", "m3", "of the chamber").positive(),
                                quantity("displacement", "m", "largest of the foil, or of all").positive(),
                                number("after_peak", "the load fell to this part of its peak")
                                    .within({0, 1, "between 0 and 1", false, false})},
                               "the path ends at the first that is reached")
                             .required()
                             .at_least_one({"load_factor", "pressure", "volume", "displacement", "after_peak"});
  const Option kinds = variant(
      "path", "type",
      {group("load", {steps}, "the load grows; automatic steps"),
       group("displacement",
             {place, foil, vector("direction", "of the displacement at a place; without it the site's up"),
              quantity("until", "m", "the displacement in the end; its sign counts along the direction").required(),
              steps},
             "a displacement grows, the load follows"),
       group("volume", {chamber, quantity("until", "m3", "the volume in the end").required().positive(), steps},
             "the volume of a chamber changes, the load follows"),
       group("arc_length", {targets, chamber, foil, steps},
             "a length along the path grows, load and displacement follow")},
      "by type");
  return either("control", {choice("word", {value("load", "the load grows; automatic steps")}, "in a word"), kinds},
                "how the path is followed")
      .otherwise("load");
}

Option contact() {
  return choice("contact", {value("stop", "ends the stage"), value("ignore", "goes on, marked")},
                "what happens when foils meet")
      .otherwise("stop");
}

Options start() {
  return {word("from", "the stage it starts from").required()};
}

Option formfind() {
  const char* isotropic = "an isotropic prestress (or stress) per foil is available: {all: 0.89 kN/m}";
  const Option prestress = either("FOIL", {isotropic_prestress(), group("warp_weft", {}, "").unavailable(isotropic)},
                                  "prestress of a foil or `all`");
  return group("formfind",
               start() + Options{pressures("the pressure of the form").required(),
                                 table("prestress", prestress, "force per length"),
                                 table("stress",
                                       quantity("FOIL", "Pa", "stress, times the nominal thickness")
                                           .positive()
                                           .usual(1e4, 5e7, "usually 0.01 to 50 MPa"),
                                       "stress of a foil or `all`"),
                                 table("sag", text("FOIL", ""), "").unavailable(isotropic),
                                 table("volume", text("CHAMBER", ""), "").unavailable(isotropic), solver_options()},
               "finds the form of given prestress and pressure")
      .exactly_one({"prestress", "stress", "sag", "volume"});
}

Option ratio(const std::string& name, const std::string& what) {
  return quantity(name, "1", what)
      .within({0, 0.5, "at least 0 % and below 50 %", true, false})
      .usual(0, 0.02, "usually up to 2 %");
}

Option pattern() {
  const Option roll = group(
      "roll",
      {quantity("width", "m", "of the film as bought").required().positive().usual(0.5, 3, "rolls are 0.5 to 3 m wide"),
       quantity("weld", "m", "width of the overlap")
           .required()
           .at_least(0, "at least 0 m")
           .usual(0.005, 0.03, "usually 5 to 30 mm"),
       quantity("selvedge", "m", "not used along both edges").required().at_least(0, "at least 0 m")},
      "the film: every strip must fit on it; alone it gives the fewest strips that fit");
  const Option curve = list("curve", point("point", "a point"), "points in plan from rim to rim").items(2, 100000);
  const Option compensation =
      either("compensation",
             {choice("kind",
                     {value("none", "the strips are as large as the form"),
                      value("elastic", "by the strain of the form's prestress")},
                     "what decides it"),
              group("given", {ratio("warp", "along the roll").required(), ratio("weft", "across the roll").required()},
                    "flat length = (1 - value) x length on the form")},
             "how much smaller the strips are cut than the form")
          .otherwise("none");
  const Option allowance = group("allowance",
                                 {quantity("clamp", "m", "of film beyond the clamped edge")
                                      .at_least(0, "at least 0 m")
                                      .usual(0, 0.5, "usually up to 0.5 m")
                                      .otherwise("30 mm"),
                                  quantity("notches", "m", "distance of the marks along the seams")
                                      .positive()
                                      .usual(0.02, 10, "usually 2 cm to 10 m")
                                      .otherwise("0.5 m")},
                                 "what is added to the net strips")
                               .otherwise("{}");
  return group(
             "pattern",
             start() +
                 Options{
                     integer("strips_per_foil", "number of strips")
                         .at_least(2, "at least 2")
                         .usual(2, 50, "usually 2 to 50"),
                     roll, table("curves", list("FOIL", curve, "of a foil or `all`").items(1, 10000), "the seams"),
                     choice("lines", {value("geodesic", "shortest on the form"), value("straight", "straight in plan")},
                            "the seams' kind")
                         .otherwise("geodesic"),
                     either("direction",
                            {choice("search", {value("auto", "the best one is searched")}, "not given"),
                             quantity("angle", "rad", "from x")},
                            "of the strips' length")
                         .otherwise("auto"),
                     choice("chosen_by",
                            {value("distortion", "least stretched when flattened"), value("waste", "least film")},
                            "what the best direction is")
                         .otherwise("distortion"),
                     compensation, ratio("creep", "beside the elastic strain").otherwise("0 %"),
                     quantity("decompensation", "m", "width along clamped edges where the compensation fades in")
                         .at_least(0, "at least 0 m")
                         .usual(0, 2, "usually up to 2 m")
                         .otherwise("0 m"),
                     list("foils", word("foil", "a foil"), "to be cut; without it all that are not flat").items(1, 16),
                     allowance, solver_options()},
             "cuts a found form into flat strips")
      .at_least_one({"strips_per_foil", "roll", "curves"})
      .not_both("strips_per_foil", "curves");
}

// Foils that flow with time need to know how long the stage takes.
Options time() {
  const Option moment = group("moment",
                              {quantity("time", "s", "since the stage began").required().at_least(0, "at least 0 s"),
                               number("factor", "part of what the stage states that acts then").required()},
                              "a moment");
  return {quantity("duration", "s", "in which all that the stage states grows evenly; without it no time passes")
              .positive()
              .usual(1e-3, 1e10, "usually from milliseconds to 100 years"),
          list("history", moment, "what acts when, from nothing at 0 s, linear between").items(1, 100000)};
}

Option inflate() {
  return group("inflate",
               start() +
                   Options{pressures("reached with regulated air").required(),
                           choice("reference",
                                  {value("prestressed", "the found form carries its prestress"),
                                   value("stress_free", "the found form is free of stress")},
                                  "of a found form"),
                           table("prestress", isotropic_prestress(), "of a flat start, per foil or `all`"), contact(),
                           control(), path_options()} +
                   time(),
               "raises the pressure")
      .not_both("duration", "history");
}

Option wind() {
  const Option gas =
      variant("CHAMBER", "law",
              {group("regulated",
                     {quantity("gauge_pressure", "Pa", "set-point; without it as in the `from` state")
                          .usual(0, 2000, "cushions hold 200 to 800 Pa, seldom up to 2 kPa")},
                     "constant pressure"),
               group("closed",
                     {number("kappa", "of p V^kappa = const: 1 slow, 1.4 gusts of seconds")
                          .within({0, 10, "above 0, up to 10", false, true})
                          .usual(1, 1.67, "air has 1 to 1.4")
                          .otherwise("1"),
                      quantity("temperature", "K", "of the air in the end")
                          .positive()
                          .usual(213.15, 373.15, "usually -60 to 100 degC"),
                      quantity("ambient_pressure", "Pa", "absolute, in the end").at_least(0, "at least 0 Pa")},
                     "the air stays"),
               group("volume", {quantity("volume", "m3", "held").required().positive()}, "incompressible")},
              "the air of a chamber")
          .otherwise("regulated");
  const Option all = choice("all", {value("all", "all of the foil")}, "all of the foil");
  const Option part = group("part",
                            {interval("x", "from, to"), interval("y", "from, to"),
                             list("polygon", point("corner", "a corner"), "corners in plan").items(3, 100000)},
                            "a part in plan")
                          .exactly_one({"x", "polygon"});
  const Option patch =
      group("patch",
            {point("center", "in plan").required(),
             list("size", length("side", "side of the rectangle"), "in plan").items(2, 2).required(),
             list("force", quantity("component", "N", "component"), "sum, dead").items(3, 3).required()},
            "a dead force spread over a rectangle in plan");
  const Option load =
      group("load",
            {word("name", "of the load").required(), word("foil", "it acts on").required(),
             quantity("wind", "Pa", "positive pushes against the face, negative is suction; follows the foil")
                 .usual(-10000, 10000, "usually up to 10 kPa"),
             quantity("snow", "Pa", "weight per plan area, straight down")
                 .at_least(0, "at least 0 Pa")
                 .usual(0, 20000, "usually up to 20 kPa"),
             patch, either("region", {all, part}, "where it acts").otherwise("all")},
            "a load")
          .exactly_one({"wind", "snow", "patch"});
  return group(
             "wind",
             start() +
                 Options{table("gas", gas, "per chamber [regulated]").otherwise("{}"),
                         list("loads", load, "what acts").otherwise("[]"),
                         table("factors", number("LOAD", "factor"),
                               "of the loads, by name; of a load of the wind stage before: the part of it that is left")
                             .otherwise("{}"),
                         contact(), control(), path_options()} +
                 time(),
             "loads the inflated cushion")
      .not_both("duration", "history");
}

Option stages(bool in_stage_file) {
  Options runs = {formfind(), pattern(), inflate(), wind()};
  if (in_stage_file) {
    for (Option& run : runs) run.members.push_back(word("from_run", "kind of the stage it starts from").required());
  }
  return table("stages", variant("ID", "run", runs, "a stage"), "the stages by their IDs");
}

Option youngs_modulus(const std::string& name, const std::string& what) {
  return quantity(name, "Pa", what).positive().usual(1e6, 1e10, "foils have 1 MPa to 10 GPa");
}

Option poissons_ratio(const std::string& name, const std::string& what) {
  return number(name, what).within({-1, 0.5, "above -1, up to 0.5", false, true});
}

// E, nu of an isotropic foil.
Options isotropic() {
  return {youngs_modulus("E", "Young's modulus"), poissons_ratio("nu", "Poisson's ratio")};
}

Options elastic() {
  return isotropic() +
         Options{youngs_modulus("E1", "Young's modulus along the warp, of an orthotropic foil"),
                 youngs_modulus("E2", "Young's modulus across the warp"),
                 number("nu12", "narrowing across the warp in tension along it, nu12^2 < E1 / E2"),
                 quantity("G12", "Pa", "shear modulus").positive().usual(1e5, 1e10, "foils have 0.1 MPa to 10 GPa")};
}

Option hardening() {
  const Option branch = group("branch",
                              {quantity("stress", "Pa", "yield stress from which on it counts")
                                   .required()
                                   .positive()
                                   .usual(1e4, 1e9, "foils yield at 10 kPa to 1 GPa"),
                               quantity("modulus", "Pa", "how the yield stress rises").required()},
                              "a branch");
  return list("hardening", branch, "branches of the yield stress, the last goes on").items(1, 1000);
}

// The law at another temperature: what changes with it.
Option other_temperatures(const Options& keys) {
  return list("temperature",
              group("temperature", Options{quantity("at", "K", "the temperature").required().positive()} + keys,
                    "what the law has there; the rest is as in the law itself"),
              "the law at other temperatures; linear between neighbours, an error outside")
      .items(1, 1000);
}

Options j2() {
  Options keys = isotropic();
  for (Option& key : keys) key = key.required();
  const Option viscosity =
      group("viscosity",
            {choice("model",
                    {value("peric", "stress = yield stress (1 + mu rate)^epsilon"),
                     value("perzyna", "stress = yield stress (1 + (mu rate)^epsilon)")},
                    "how the stress rises with the rate of plastic strain")
                 .required(),
             quantity("mu", "s", "time scale").required().positive().usual(1e-9, 1e12, "usually 1 ns to 30000 years"),
             number("epsilon", "sensitivity to the rate").required().within({0, 10, "above 0, up to 10", false, true}),
             quantity("threshold", "Pa", "stress from which on it flows, up to first yield; without it first yield")
                 .at_least(0, "at least 0 Pa")},
            "flow with time");
  return keys +
         Options{
             hardening().required(),
             choice("modulus",
                    {value("plastic", "d stress / d plastic strain"), value("tangent", "d stress / d strain, < E")},
                    "what the moduli of the branches are")
                 .otherwise("plastic"),
             flag("softening", "a branch before the last may fall; the result then depends on the mesh")
                 .otherwise("off"),
             choice("strain",
                    {value("logarithmic", "large strain, Kirchhoff stress"),
                     value("small", "Green-Lagrange strain and second Piola-Kirchhoff stress, up to a few percent")},
                    "measure of strain")
                 .otherwise("logarithmic"),
             viscosity,
             other_temperatures(isotropic() + Options{hardening()})};
}

// Of PD-NURBS and LE-NURBS.
Options table_law(bool along_axes) {
  const auto files = [](const char* name, const char* what) {
    return either(name,
                  {text("file", "CSV file beside the one that names it"),
                   list("files", text("file", "CSV file"), "several").items(1, 1000)},
                  what);
  };
  const auto row = [](std::size_t size, const char* what) {
    return list("row", number("value", "value"), what).items(size, size);
  };
  Options keys = {
      files("data", "points of tests: strain_1, strain_2, stress_1, stress_2 and perhaps weight"),
      list("points", row(5, "a point"),
           "such points in place: Green-Lagrange strains, second Piola-Kirchhoff stresses in Pa, weight"),
      choice("measure",
             {value("engineering", "change of length, force per undeformed area"),
              value("green_lagrange", "with second Piola-Kirchhoff stress")},
             "of strains and stresses in `data`")
          .otherwise("engineering"),
      word("fit_to", "another material that the table shall follow"),
      list("net", integer("n", "control points").between(3, 200, "from 3 to 200"),
           "control points of the table along both strains")
          .items(2, 2)
          .otherwise("[25, 25]"),
      integer("degree", "of the stress surfaces").between(2, 6, "from 2 to 6").otherwise("3"),
      list("range", number("strain", "Green-Lagrange strain").within({-0.5, 10, "above -0.5, up to 10", false, true}),
           "of strains in the table; without it that of the points")
          .items(2, 2),
      choice("outside",
             {value("error", "ends the stage"), value("linear", "the stress goes on linearly, and that is reported")},
             "what happens where a strain leaves the data")
          .otherwise("error"),
      flag("potential",
           "the stresses are derivatives of one stored energy; off: fitted apart, at the price of more iterations")
          .otherwise("on"),
      number("smoothing", "weight of bends in the surfaces against residuals; without it as little as the points need")
          .within({0, 1e6, "above 0, up to 1e6", false, true}),
      poissons_ratio("nu", "of the thickness, about which the points say nothing; 0.5: the volume stays")
          .otherwise("0.5")};
  if (along_axes) {
    keys.push_back(files("shear_data", "points of shear tests: shear_strain (2 E12), shear_stress (S12)"));
    keys.push_back(list("shear_points", row(3, "a point"), "such points in place: 2 E12, S12 in Pa, weight"));
  }
  return keys;
}

Option strength() {
  const Option factor = group("temperature",
                              {quantity("at", "K", "the temperature").required().positive(),
                               number("factor", "of the strength there").required().positive()},
                              "a temperature");
  return group("strength",
               {quantity("characteristic", "Pa", "strength that design starts from").required().positive(),
                quantity("weld", "Pa", "of a weld, at break").positive(),
                quantity("ultimate", "Pa", "of the foil, at break").positive(),
                table("factors", number("NAME", "factor").positive(), "that the strength is divided by, all of them")
                    .otherwise("{}"),
                list("temperature", factor, "by which it is divided too, linear between").otherwise("[]"),
                text("source", "where the values come from")},
               "what the report compares stresses with");
}

Option material() {
  const auto law = [](const char* name, const Options& keys, const char* what) {
    return group(
        name,
        keys + Options{flag("tension_field", "a foil that cannot carry compression").otherwise("off"),
                       quantity("density", "kg/m3", "for gravity").positive().usual(100, 10000, "ETFE has 1750 kg/m3"),
                       quantity("thermal_expansion", "K-1", "linear"), strength(),
                       text("source", "where the values come from")},
        what);
  };
  const Option at =
      quantity("at", "K", "temperature at which the law's own values hold").positive().otherwise("23 degC");
  const Option C1 = quantity("C1", "Pa", "of W = C1 (I1 - 3) + C2 (I2 - 3); half the shear modulus without C2")
                        .required()
                        .positive()
                        .usual(1e4, 1e9, "rubber and foils have 10 kPa to 1 GPa");
  const Option term =
      group("term",
            {quantity("mu", "Pa", "of W = sum mu / alpha (l1^alpha + l2^alpha + l3^alpha - 3)").required(),
             number("alpha", "exponent of the stretches").required()},
            "a term");
  return variant(
      "NAME", "law",
      {law("elastic", elastic() + Options{at, other_temperatures(elastic())},
           "St. Venant-Kirchhoff, isotropic (E, nu) or orthotropic (E1, E2, nu12, G12)")
           .exactly_one({"E", "E1"}),
       law("j2", j2() + Options{at}, "von Mises plasticity, viscoplastic with `viscosity`"),
       law("ogden", {list("terms", term, "of the stored energy").items(1, 8).required()},
           "incompressible, hyperelastic"),
       law("mooney_rivlin",
           {C1,
            quantity("C2", "Pa", "of W").required().at_least(0, "at least 0 Pa").usual(0, 1e9, "usually up to 1 GPa")},
           "incompressible, hyperelastic"),
       law("neo_hooke", {C1}, "incompressible, hyperelastic: mooney_rivlin with C2 = 0"),
       law("pd_nurbs", table_law(false), "isotropic table of principal stresses over principal strains")
           .at_least_one({"data", "points", "fit_to"})
           .not_both("data", "points"),
       law("le_nurbs", table_law(true), "table of stresses over strains along the foil's axes")
           .exactly_one({"data", "points", "fit_to"})
           .not_both("shear_data", "shear_points")},
      "a material");
}

Option root(bool in_stage_file) {
  const Option materials = either("materials",
                                  {text("file", "a file of materials"),
                                   list("files", text("file", "a file of materials"), "files of materials"),
                                   table("in_place", material(), "materials in place")},
                                  "where the materials of the foils are");
  const char* stage = "loads stand in a wind stage";
  Options keys = {
      integer("pneuma", "version of the format").between(1, 1, "1, the version this program reads").required(),
      text("name", "of the project").otherwise("\"\""),
      materials.required(),
      site(),
      cushion().required(),
      in_stage_file ? mesh() : mesh().required(),
      stages(in_stage_file).otherwise("{}"),
      table("loads", text("load", ""), "").unavailable(stage),
      table("combinations", text("combination", ""), "").unavailable(stage),
      table("accuracy", text("goal", ""), "").unavailable("choose the mesh size by hand")};
  return group("workflow", keys, "From form to wind for ETFE cushions");
}

} // namespace

const Option& workflow_options() {
  static const Option option = root(false);
  return option;
}

const Option& stage_file_options() {
  static const Option option = root(true);
  return option;
}

const Option& materials_file_options() {
  static const Option option = table("materials", material(), "materials by their names");
  return option;
}

std::string workflow_json_schema() {
  return schema::json_schema(workflow_options(), "Pneuma workflow");
}

std::string workflow_reference() {
  return schema::reference(workflow_options());
}

} // namespace pneuma::pipeline::workflow
