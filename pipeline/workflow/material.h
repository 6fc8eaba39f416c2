// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>

#include "pipeline/test_data/coverage.h"
#include "pipeline/test_data/test_data.h"
#include "pipeline/workflow/forms.h"

// The laws of foils as an engineer gives them. Whether their values make a law, the law itself judges
// (solver/material), asked by the stages.
namespace pneuma::pipeline::workflow {

using yaml::Mark; // where a value stands in the user's file

inline Form<double> youngs_modulus() {
  return quantity("Pa").positive().usual(1e6, 1e10, "foils have 1 MPa to 10 GPa").such_as("900 MPa");
}

inline Form<double> poissons_ratio() {
  return number().within({-1, 0.5, "above -1, up to 0.5", false, true});
}

// A struct of numbers, in the order of its members.
template <class Row>
Form<Row> row() {
  using Numbers = std::array<double, sizeof(Row) / sizeof(double)>;
  return mapped<Row>(tuple<std::tuple_size_v<Numbers>>(number().named("value", "value")), std::bit_cast<Row, Numbers>,
                     std::bit_cast<Numbers, Row>)
      .named("row", "a point");
}

// Isotropic, St. Venant-Kirchhoff.
struct ElasticLaw {
  double E = 0;  // Pa
  double nu = 0; // -

  static void declare(auto& keys) {
    keys("E", &ElasticLaw::E, youngs_modulus(), "Young's modulus");
    keys("nu", &ElasticLaw::nu, poissons_ratio(), "Poisson's ratio");
    keys.is("elastic", "St. Venant-Kirchhoff, isotropic (E, nu) or orthotropic (E1, E2, nu12, G12)");
  }
};

// 1 along the foil's warp; nu12: narrowing along 2 in tension along 1.
struct OrthotropicLaw {
  double E1 = 0, E2 = 0; // Pa
  double nu12 = 0;       // -
  double G12 = 0;        // Pa

  static void declare(auto& keys) {
    using Self = OrthotropicLaw;
    keys("E1", &Self::E1, youngs_modulus(), "Young's modulus along the warp, of an orthotropic foil");
    keys("E2", &Self::E2, youngs_modulus(), "Young's modulus across the warp");
    keys("nu12", &Self::nu12, number(), "narrowing across the warp in tension along it, nu12^2 < E1 / E2");
    keys("G12", &Self::G12,
         quantity("Pa").positive().usual(1e5, 1e10, "foils have 0.1 MPa to 10 GPa").such_as("300 MPa"),
         "shear modulus");
    keys.is("elastic", "orthotropic (E1, E2, nu12, G12)", "E1");
  }
};

// From this yield stress on, up to that of the next branch; Pa.
struct HardeningBranch {
  double stress = 0;
  double modulus = 0; // plastic or tangent, as the law says

  static void declare(auto& keys) {
    keys("stress", &HardeningBranch::stress,
         quantity("Pa").positive().usual(1e4, 1e9, "foils yield at 10 kPa to 1 GPa").such_as("15 MPa"),
         "yield stress from which on it counts");
    keys("modulus", &HardeningBranch::modulus, quantity("Pa").such_as("72 MPa"), "how the yield stress rises");
  }
};

enum class ModulusKind : std::uint8_t { plastic, tangent }; // d stress / d plastic strain, or d stress / d strain

struct ViscositySettings {
  enum class Model : std::uint8_t { peric, perzyna } model = Model::peric;
  double mu = 0;                   // s
  double epsilon = 0;              // -
  std::optional<double> threshold; // Pa; none: first yield

  static void declare(auto& keys) {
    using Self = ViscositySettings;
    keys("model", &Self::model,
         choice<Model>({{"peric", Model::peric, "stress = yield stress (1 + mu rate)^epsilon"},
                        {"perzyna", Model::perzyna, "stress = yield stress (1 + (mu rate)^epsilon)"}}),
         "how the stress rises with the rate of plastic strain");
    keys("mu", &Self::mu, quantity("s").positive().usual(1e-9, 1e12, "usually 1 ns to 30000 years"), "time scale");
    keys("epsilon", &Self::epsilon, number().within({0, 10, "above 0, up to 10", false, true}),
         "sensitivity to the rate");
    keys("threshold", &Self::threshold, quantity("Pa").at_least(0, "at least 0 Pa").such_as("1.5 MPa"),
         "stress from which on it flows, up to first yield; without it first yield");
  }
};

// J2 plasticity, isotropic hardening; viscoplastic with a viscosity.
struct J2Law {
  double E = 0;  // Pa
  double nu = 0; // -
  std::vector<HardeningBranch> hardening;
  ModulusKind modulus = ModulusKind::plastic;
  bool softening = false;   // a branch may fall
  bool logarithmic = false; // large strain; otherwise small strain
  std::optional<ViscositySettings> viscosity;

  static void declare_varying(auto& keys) { // with temperature
    keys("E", &J2Law::E, youngs_modulus(), "Young's modulus");
    keys("nu", &J2Law::nu, poissons_ratio(), "Poisson's ratio");
    keys("hardening", &J2Law::hardening, list(group<HardeningBranch>().named("branch", "a branch")).items(1, 1000),
         "branches of the yield stress, the last goes on");
  }
  static void declare(auto& keys) {
    declare_varying(keys);
    keys("modulus", &J2Law::modulus,
         choice<ModulusKind>({{"plastic", ModulusKind::plastic, "d stress / d plastic strain"},
                              {"tangent", ModulusKind::tangent, "d stress / d strain, < E"}})
             .otherwise("plastic"),
         "what the moduli of the branches are");
    keys("softening", &J2Law::softening, flag().otherwise("off"),
         "a branch before the last may fall; the result then depends on the mesh");
    keys(
        "strain", &J2Law::logarithmic,
        choice<bool>({{"logarithmic", true, "large strain, Kirchhoff stress"},
                      {"small", false, "Green-Lagrange strain and second Piola-Kirchhoff stress, up to a few percent"}})
            .otherwise("logarithmic"),
        "measure of strain");
    keys("viscosity", &J2Law::viscosity, group<ViscositySettings>(), "flow with time");
    keys.is("j2", "von Mises plasticity, viscoplastic with `viscosity`");
  }
};

// Incompressible, W = sum mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3).
struct OgdenLaw {
  struct Term {
    double mu = 0;    // Pa
    double alpha = 0; // -

    static void declare(auto& keys) {
      keys("mu", &Term::mu, quantity("Pa").such_as("630 kPa"),
           "of W = sum mu / alpha (l1^alpha + l2^alpha + l3^alpha - 3)");
      keys("alpha", &Term::alpha, number(), "exponent of the stretches");
    }
  };
  std::vector<Term> terms;

  static void declare(auto& keys) {
    keys("terms", &OgdenLaw::terms, list(group<Term>().named("term", "a term")).items(1, 8), "of the stored energy");
    keys.is("ogden", "incompressible, hyperelastic");
  }
};

// Incompressible, W = C1 (I1 - 3) + C2 (I2 - 3); neo-Hooke is C2 = 0.
struct MooneyRivlinLaw {
  double C1 = 0, C2 = 0; // Pa

  static void declare_neo_hooke(auto& keys) {
    keys("C1", &MooneyRivlinLaw::C1,
         quantity("Pa").positive().usual(1e4, 1e9, "rubber and foils have 10 kPa to 1 GPa").such_as("0.6 MPa"),
         "of W = C1 (I1 - 3) + C2 (I2 - 3); half the shear modulus without C2");
    keys.is("neo_hooke", "incompressible, hyperelastic: mooney_rivlin with C2 = 0");
  }
  static void declare(auto& keys) {
    declare_neo_hooke(keys);
    keys("C2", &MooneyRivlinLaw::C2,
         quantity("Pa").at_least(0, "at least 0 Pa").usual(0, 1e9, "usually up to 1 GPa").such_as("0.1 MPa"), "of W");
    keys.is("mooney_rivlin", "incompressible, hyperelastic");
  }
};

// Elastic, from a table that is fitted to test points, to another material, or to points filled up with one: PD-NURBS
// in principal directions (isotropic), LE-NURBS along the foil's axes.
struct TableLaw {
  using Point = test_data::Point;
  struct ShearPoint {
    double strain = 0, stress = 0, weight = 1; // 2 E12; S12, Pa
  };
  enum class Kind : std::uint8_t { pd_nurbs, le_nurbs } kind = Kind::pd_nurbs;
  using Measure = test_data::Measure;
  bool has_axes() const { return kind == Kind::le_nurbs; }

  std::vector<std::string> data, shear_data; // files; their points are among those below as soon as they are read
  Measure measure = Measure::engineering;    // of the files
  std::vector<Point> points;
  std::vector<ShearPoint> shear_points; // of le_nurbs
  std::optional<std::string> fit_to;    // material
  std::array<int, 2> net{};             // control points of the stress surfaces
  int degree = 0;
  std::optional<std::array<double, 2>> range; // Green-Lagrange strain; none: that of the points
  bool goes_on = false;                       // linearly outside the data; otherwise an error
  bool potential = false;                     // stresses are derivatives of one potential
  std::optional<double> smoothing;            // weight of bends against residuals; none: as the fit chooses
  double nu = 0;                              // of the thickness, about which the points say nothing

  static void declare(auto& keys, Kind kind = Kind::le_nurbs) {
    const bool along_axes = kind == Kind::le_nurbs;
    const auto files = [] {
      const auto file = text().named("file", "CSV file beside the one that names it");
      const auto one = mapped<std::vector<std::string>>(
          file, [](const std::string& name) { return std::vector{name}; },
          [](const std::vector<std::string>& names) { return names.front(); });
      return either<std::vector<std::string>>(
          {one, list(file).items(1, 1000).named("files", "several")},
          [](const std::vector<std::string>& names) { return names.size() == 1 ? 0 : 1; });
    };
    const auto of_tests = [](const auto& law) { return !law.data.empty() || !law.shear_data.empty(); };

    keys("data", &TableLaw::data, files(), "points of tests: strain_1, strain_2, stress_1, stress_2 and perhaps weight")
        .or_another();
    keys("points", &TableLaw::points, list(row<Point>()).items(1, 100000),
         "such points in place: Green-Lagrange strains, second Piola-Kirchhoff stresses in Pa, weight")
        .or_another();
    if (along_axes) {
      keys("shear_data", &TableLaw::shear_data, files(),
           "points of shear tests: shear_strain (2 E12), shear_stress (S12)")
          .or_another();
      keys("shear_points", &TableLaw::shear_points, list(row<ShearPoint>()).items(1, 100000),
           "such points in place: 2 E12, S12 in Pa, weight")
          .or_another();
      keys.not_both("shear_data", "shear_points");
    }
    keys("measure", &TableLaw::measure,
         choice<Measure>({{"engineering", Measure::engineering, "change of length, force per undeformed area"},
                          {"green_lagrange", Measure::green_lagrange, "with second Piola-Kirchhoff stress"}})
             .otherwise("engineering"),
         "of strains and stresses in `data`")
        .where(of_tests, "is for `data`");
    keys("fit_to", &TableLaw::fit_to, word(), "another material that the table shall follow");
    keys("net", &TableLaw::net,
         tuple<2>(integer().between(3, 200, "from 3 to 200").named("n", "control points")).otherwise("[25, 25]"),
         "control points of the table along both strains");
    keys("degree", &TableLaw::degree, integer().between(2, 6, "from 2 to 6").otherwise("3"), "of the stress surfaces");
    keys("range", &TableLaw::range,
         tuple<2>(
             number().within({-0.5, 10, "above -0.5, up to 10", false, true}).named("strain", "Green-Lagrange strain")),
         "of strains in the table; without it that of the points");
    keys("outside", &TableLaw::goes_on,
         choice<bool>({{"error", false, "ends the stage"},
                       {"linear", true, "the stress goes on linearly, and that is reported"}})
             .otherwise("error"),
         "what happens where a strain leaves the data");
    keys("potential", &TableLaw::potential, flag().otherwise("on"),
         "the stresses are derivatives of one stored energy; off: fitted apart, at the price of more iterations");
    keys("smoothing", &TableLaw::smoothing, number().within({0, 1e6, "above 0, up to 1e6", false, true}),
         "weight of bends in the surfaces against residuals; without it as little as the points need");
    keys("nu", &TableLaw::nu, poissons_ratio().otherwise("0.5"),
         "of the thickness, about which the points say nothing; 0.5: the volume stays");
    if (along_axes) {
      keys.is("le_nurbs", "table of stresses over strains along the foil's axes");
      keys.exactly_one({"data", "points", "fit_to"});
      for (const char* points : {"data", "points"}) {
        keys.needs(points, {"shear_data", "shear_points"}, "points along the axes say nothing about shear");
      }
    } else {
      keys.is("pd_nurbs", "isotropic table of principal stresses over principal strains");
      keys.at_least_one({"data", "points", "fit_to"});
      keys.not_both("data", "points");
    }
    keys.needs("fit_to", {"range"}, "another material has strains without end; say which the table shall hold");
  }
  static void check(Reader& reader, const At<TableLaw>& law);
};

using MaterialLaw = std::variant<ElasticLaw, OrthotropicLaw, J2Law, OgdenLaw, MooneyRivlinLaw, TableLaw>;

// What the report compares stresses with: f_d = characteristic / (product of factors x factor of the temperature).
struct Strength {
  struct AtTemperature {
    double at = 0; // K
    double factor = 0;

    static void declare(auto& keys) {
      keys("at", &AtTemperature::at, quantity("K").positive(), "the temperature");
      keys("factor", &AtTemperature::factor, number().positive(), "of the strength there");
    }
  };
  double characteristic = 0;              // Pa
  std::optional<double> weld, ultimate;   // Pa
  std::map<std::string, double> factors;  // by name, -
  std::vector<AtTemperature> temperature; // rising
  std::optional<std::string> source;

  static void declare(auto& keys) {
    const auto stress = quantity("Pa").positive().such_as("21 MPa");
    keys("characteristic", &Strength::characteristic, stress, "strength that design starts from");
    keys("weld", &Strength::weld, stress, "of a weld, at break");
    keys("ultimate", &Strength::ultimate, stress, "of the foil, at break");
    keys("factors", &Strength::factors, table(number().positive().named("NAME", "factor")).otherwise("{}"),
         "that the strength is divided by, all of them");
    keys("temperature", &Strength::temperature,
         list(group<AtTemperature>().named("temperature", "a temperature")).otherwise("[]"),
         "by which it is divided too, linear between");
    keys("source", &Strength::source, text(), "where the values come from");
  }
  static void check(Reader& reader, const At<Strength>& strength);
};

// A resolved material.
struct Material {
  std::string name;
  struct AtTemperature {
    double at = 0;   // K
    MaterialLaw law; // of the same kind as that of the material
  };
  MaterialLaw law;                         // at `at`
  double at = 0;                           // K
  std::vector<AtTemperature> other;        // in the order of the file
  bool tension_field = false;              // cannot carry compression
  std::optional<double> density;           // kg/m3
  std::optional<double> thermal_expansion; // 1/K
  std::optional<Strength> strength;
  std::optional<std::string> source;
  std::map<std::string, Mark> places; // where the user has its values: "E", "hardening.1.modulus", "" for itself

  static void declare(auto& keys) { // what all laws have
    keys("tension_field", &Material::tension_field, flag().otherwise("off"), "a foil that cannot carry compression");
    keys("density", &Material::density, quantity("kg/m3").positive().usual(100, 10000, "ETFE has 1750 kg/m3"),
         "for gravity");
    keys("thermal_expansion", &Material::thermal_expansion, quantity("K-1"), "linear");
    keys("strength", &Material::strength, group<Strength>(), "what the report compares stresses with");
    keys("source", &Material::source, text(), "where the values come from");
  }
};

Form<Material> material();

} // namespace pneuma::pipeline::workflow
