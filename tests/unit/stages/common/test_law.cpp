// SPDX-License-Identifier: GPL-3.0-or-later
// From the settings of a material to the solver's law: values, moduli, temperatures, tables.
#include <gmock/gmock.h>

#include "geometry/base/errors.h"
#include "stages/common/law.h"
#include "tests/places.h"
#include "tests/unit/message_of.h"

namespace pneuma::stages::common {
namespace {

using base::Vec3;
using pipeline::workflow::Material;
using solver::material::Response;
using testing::HasSubstr;
using tests::message_of;
namespace workflow = pipeline::workflow;

constexpr double room = 296.15; // K

Material material_of(workflow::MaterialLaw law) {
  Material material;
  material.name = "foil";
  material.places[""] = {"etfe.yaml", 3, 1};
  material.at = room;
  material.law = std::move(law);
  return material;
}

MaterialLaw made_of(const Material& material, double temperature = room) {
  return law_of({{material.name, material}}, material.name, temperature);
}

Response answer(const solver::material::Law& law, const Vec3& strain) {
  std::vector<double> old_history(static_cast<std::size_t>(solver::material::history_components(law)) + 1, 0.0);
  std::vector<double> new_history = old_history;
  solver::material::Batch batch;
  batch.count = 1;
  batch.strain[0] = strain;
  batch.old_history = old_history.data();
  batch.new_history = new_history.data();
  EXPECT_EQ(solver::material::evaluate(law, batch), -1);
  return batch.response[0];
}

workflow::J2Law etfe() {
  auto law = pipeline::schema::defaults<workflow::J2Law>();
  law.E = 900e6;
  law.nu = 0.45;
  law.hardening = {{15e6, 72e6}, {21e6, 40e6}};
  return law;
}

// What the law does uniaxially is E e, then sigma_y + K alpha, K the plastic modulus; S22 = 0 at the returned strain.
double uniaxial_stress(const solver::material::Law& law, double strain) {
  Vec3 e(strain, -0.45 * strain, 0);
  for (int i = 0; i < 50; ++i) {
    const Response r = answer(law, e);
    e[1] -= r.stress[1] / r.tangent(1, 1);
  }
  return answer(law, e).stress[0];
}

TEST(Law, EveryKindOfSettingsHasItsLawAndItsTensionField) {
  const std::vector<workflow::MaterialLaw> kinds = {
      workflow::ElasticLaw{9e8, 0.45}, workflow::OrthotropicLaw{9e8, 8e8, 0.4, 3e8}, etfe(),
      workflow::OgdenLaw{{{6e5, 1.3}, {-1e4, -2}}}, workflow::MooneyRivlinLaw{25e6, 7e6}};
  for (const workflow::MaterialLaw& kind : kinds) {
    Material material = material_of(kind);
    const solver::material::Law taut = made_of(material).law;
    material.tension_field = true;
    const solver::material::Law field = made_of(material).law;
    EXPECT_FALSE(solver::material::has_tension_field(taut)) << kind.index();
    EXPECT_TRUE(solver::material::has_tension_field(field)) << kind.index();
    const Vec3 stretched(0.01, 0.005, 0.002);
    EXPECT_EQ(answer(taut, stretched).stress, answer(field, stretched).stress) << kind.index();
    EXPECT_EQ(answer(field, Vec3(-0.01, -0.02, 0)).stress, Vec3::Zero()) << kind.index();
  }
}

TEST(Law, OrthotropicValuesStandWhereTheyBelong) {
  const Response r =
      answer(made_of(material_of(workflow::OrthotropicLaw{9e8, 4e8, 0.3, 2e8})).law, Vec3(1e-3, 0, 1e-3));
  const double c = 1 / (1 - 0.09 * 4 / 9); // 1 / (1 - nu12^2 E2 / E1)
  EXPECT_NEAR(r.stress[0], c * 9e5, 1e-6);
  EXPECT_NEAR(r.stress[1], c * 0.3 * 4e5, 1e-6);
  EXPECT_NEAR(r.stress[2], 2e5, 1e-6);
}

TEST(Law, PlasticAndTangentModulusAreTheSameFoil) {
  workflow::J2Law plastic = etfe();
  plastic.logarithmic = false;
  workflow::J2Law tangent = plastic;
  tangent.modulus = workflow::ModulusKind::tangent;
  for (workflow::HardeningBranch& branch : tangent.hardening) {
    branch.modulus = plastic.E * branch.modulus / (plastic.E + branch.modulus);
  }
  const solver::material::Law a = made_of(material_of(plastic)).law, b = made_of(material_of(tangent)).law;
  for (const double strain : {0.01, 0.05, 0.15}) {
    EXPECT_NEAR(uniaxial_stress(a, strain), uniaxial_stress(b, strain), 1e-4) << strain; // Pa, to rounding
  }
  // on the first branch of the tangent law d stress / d strain is what its user wrote
  const double slope = (uniaxial_stress(b, 0.04) - uniaxial_stress(b, 0.03)) / 0.01;
  EXPECT_NEAR(slope, tangent.hardening[0].modulus, 1); // Pa: linear there
}

TEST(Law, SmallAndLogarithmicStrainAreTwoLaws) {
  workflow::J2Law law = etfe();
  EXPECT_TRUE(std::holds_alternative<solver::material::Logarithmic>(made_of(material_of(law)).law));
  law.logarithmic = false;
  EXPECT_TRUE(std::holds_alternative<solver::material::J2>(made_of(material_of(law)).law));
}

TEST(Law, ViscosityMakesItRateDependent) {
  workflow::J2Law law = etfe();
  EXPECT_FALSE(solver::material::is_rate_dependent(made_of(material_of(law)).law));
  law.viscosity = workflow::ViscositySettings{workflow::ViscositySettings::Model::perzyna, 10, 0.5, 1.5e6};
  const solver::material::Law made = made_of(material_of(law)).law;
  EXPECT_TRUE(solver::material::is_rate_dependent(made));
  const solver::material::Viscosity& viscosity = std::get<solver::material::Logarithmic>(made).flow.viscosity;
  EXPECT_EQ(viscosity.model, solver::material::Overstress::perzyna);
  EXPECT_EQ(viscosity.mu, 10);
  EXPECT_EQ(viscosity.epsilon, 0.5);
  EXPECT_EQ(viscosity.threshold, 1.5e6);
}

TEST(Law, TakesItsValuesAtTheTemperature) {
  Material material = material_of(workflow::ElasticLaw{9e8, 0.45});
  material.other.push_back({room + 20, workflow::ElasticLaw{7e8, 0.43}});
  const auto made = std::get<solver::material::StVenantKirchhoff>(made_of(material, room + 5).law);
  EXPECT_DOUBLE_EQ(made.youngs_modulus, 8.5e8);
  EXPECT_DOUBLE_EQ(made.poissons_ratio, 0.445);
}

TEST(BadLaw, OutsideTheTemperaturesOfItsTableIsToldWithItsPlace) {
  Material material = material_of(workflow::ElasticLaw{9e8, 0.45});
  material.other.push_back({273.15, workflow::ElasticLaw{1e9, 0.45}});
  EXPECT_EQ(message_of<base::InputError>([&] { made_of(material, room + 7); }),
            "etfe.yaml:3:1: material `foil`: its values are for 0 to 23 degC, not 30 degC");
}

TEST(BadLaw, UnstableOgdenConstantsAreToldWithWhereTheyAre) {
  const Material material = material_of(workflow::OgdenLaw{{{6e6, 2}, {-1e6, 4}}});
  EXPECT_THAT(message_of<base::InputError>([&] { made_of(material); }),
              HasSubstr("etfe.yaml:3:1: material `foil`: its Ogden constants are unstable, more strain needs less "
                        "stress, in uniaxial tension at stretches from 0.25 to 0.333, "));
}

TEST(BadLaw, TellsAllItsFaults) {
  workflow::J2Law law = etfe();
  law.E = 0;
  law.hardening[1].stress = -1;
  EXPECT_EQ(message_of<base::InputError>([&] { made_of(material_of(law)); }),
            "etfe.yaml:3:1: material `foil`: `E` must be positive, not 0 MPa\n"
            "etfe.yaml:3:1: material `foil`: `stress` must be positive, not -1e-06 MPa");
}

std::string told_of(const std::map<std::string, Material>& materials, double temperature = room) {
  return message_of<base::InputError>([&] { check_laws(materials, temperature); });
}

TEST(CheckOfLaws, TellsTheFaultsOfAllMaterialsAtAllTemperaturesOnce) {
  workflow::J2Law law = etfe();
  law.hardening[1].stress = 15e6;
  Material foil = material_of(law);
  law.nu = 0.6;
  foil.other.push_back({room + 20, law});
  Material other = material_of(workflow::MooneyRivlinLaw{-1e6, 0});
  other.name = "other";
  const std::map<std::string, Material> materials = {{"foil", foil}, {"other", other}};
  EXPECT_EQ(told_of(materials),
            "etfe.yaml:3:1: material `foil`: yield stresses must rise from branch to branch: 15 MPa after 15 MPa\n"
            "etfe.yaml:3:1: material `foil`: at 43 degC: `nu` must be above -1, up to 0.5, not 0.6\n"
            "etfe.yaml:3:1: material `other`: `C1` must be positive, not -1 MPa");
}

TEST(CheckOfLaws, JudgesTheLawBetweenTwoTemperatures) {
  workflow::J2Law law = etfe();
  law.softening = true;
  Material foil = material_of(law);
  law.hardening = {{21e6, -72e6}, {15e6, 0}};
  foil.other.push_back({room + 20, law});
  EXPECT_EQ(told_of({{"foil", foil}}), "nothing was thrown");
  const char* message =
      "etfe.yaml:3:1: material `foil`: at 33 degC, between two temperatures of its table: a branch of modulus 0 MPa "
      "never comes to the next one's yield stress, 18 MPa; only the last branch may be level";
  EXPECT_EQ(told_of({{"foil", foil}}, room + 10), message);
  EXPECT_EQ(message_of<base::InputError>([&] { made_of(foil, room + 10); }), message);
  EXPECT_EQ(told_of({{"foil", foil}}, room - 1),
            "etfe.yaml:3:1: material `foil`: its values are for 23 to 43 degC, not 22 degC");
}

TEST(CheckOfLaws, WarnsOfWhatIsNoError) {
  testing::internal::CaptureStderr();
  check_laws({{"foil", material_of(workflow::OgdenLaw{{{6e6, 2}, {-1e6, 2}}})}}, room);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("etfe.yaml:3:1: warning: material `foil`: `mu` -1 MPa and `alpha` 2 have different signs"));
}

TEST(CheckOfLaws, FitsNoTable) {
  auto law = pipeline::schema::defaults<workflow::TableLaw>();
  law.points = {{0.01, 0.01, 9e6, 9e6, 1}};
  EXPECT_NO_THROW(check_laws({{"foil", material_of(law)}}, room));
}

TEST(BadLaw, TableThatItsPointsDoNotDetermineIsToldWithItsPlace) {
  auto law = pipeline::schema::defaults<workflow::TableLaw>();
  law.points = {{0.01, 0.01, 9e6, 9e6, 1}, {0.01, 0.01, 9e6, 9e6, 1}};
  law.range = {-0.01, 0.02};
  EXPECT_THAT(message_of<base::InputError>([&] { made_of(material_of(law)); }),
              HasSubstr("etfe.yaml:3:1: material `foil`: its table cannot be fitted: "));
}

TEST(Law, TableKnowsWhatItsTestsLeaveOpen) {
  auto law = pipeline::schema::defaults<workflow::TableLaw>();
  for (const double strain : {0.01, 0.02, 0.05}) {
    // E 900 MPa, nu 0.45: S = E (e1 + nu e2) / (1 - nu2)
    for (const double other : {strain, 0.05 * strain}) { // 1:1, and almost 2:1
      const double c = 900e6 / (1 - 0.45 * 0.45);
      law.points.push_back({strain, other, c * (strain + 0.45 * other), c * (other + 0.45 * strain), 1});
    }
  }
  const MaterialLaw made = made_of(material_of(law));
  ASSERT_TRUE(made.least_stress_ratio);
  EXPECT_NEAR(*made.least_stress_ratio, (0.05 + 0.45) / (1 + 0.45 * 0.05), 1e-12); // of the closed form, rounding
  EXPECT_THAT(made.missing_tests, HasSubstr("no test is near uniaxial stress, the smaller stress is at least 0.49"));
  law.points.push_back({0.05, -0.45 * 0.05, 45e6, 0, 1});
  EXPECT_EQ(made_of(material_of(law)).missing_tests, "");
  EXPECT_EQ(made_of(material_of(law)).least_stress_ratio, 0);
}

TEST(Law, TableFollowsTheMaterialItIsFittedTo) {
  auto table = pipeline::schema::defaults<workflow::TableLaw>();
  table.fit_to = "model";
  table.range = {-0.05, 0.3};
  Material model = material_of(workflow::MooneyRivlinLaw{25e6, 7e6});
  model.name = "model";
  for (const auto kind : {workflow::TableLaw::Kind::pd_nurbs, workflow::TableLaw::Kind::le_nurbs}) {
    table.kind = kind;
    Material material = material_of(table);
    material.tension_field = true;
    const MaterialLaw made = law_of({{"foil", material}, {"model", model}}, "foil", room);
    ASSERT_TRUE(made.fit);
    EXPECT_EQ(made.shear_fit.has_value(), kind == workflow::TableLaw::Kind::le_nurbs);
    EXPECT_LT(made.fit->max, 1e-3 * made.fit->largest_stress); // a smooth law, 25 x 25 control points
    EXPECT_TRUE(made.fit->monotone);
    EXPECT_TRUE(solver::material::has_tension_field(made.law));
    const Vec3 strain(0.2, 0.1, 0);
    const Vec3 exact = answer(made_of(model).law, strain).stress;
    EXPECT_LT((answer(made.law, strain).stress - exact).norm(), 1e-3 * exact.norm());
  }
}

TEST(Law, EveryMaterialOfThisRepositoryHasOneAndASource) {
  workflow::MaterialsResult library =
      workflow::read_materials(std::string(tests::source_folder) + "/configs/materials/etfe.yaml", {});
  for (const workflow::Problem& problem : library.problems) ADD_FAILURE() << to_string(problem);
  EXPECT_EQ(library.materials.size(), library.names.size());
  for (const Material& material : library.materials) {
    library.known.at(material.name).tension_field = false; // uniaxial stress is at its border
    const MaterialLaw made = law_of(library.known, material.name, room);
    EXPECT_TRUE(!made.fit || made.fit->monotone) << material.name;
    EXPECT_THAT(material.source.value_or(""), HasSubstr(":")) << material.name << ": a mark, then the source";
    EXPECT_EQ(material.density, 1750) << material.name;
    const double stress = uniaxial_stress(made.law, 0.005);
    const auto* j2 = std::get_if<workflow::J2Law>(&material.law);
    const double E = j2 != nullptr ? j2->E : 900e6;
    EXPECT_NEAR(stress, 0.005 * E, 0.02 * stress) << material.name; // squares of the strain
  }
}

} // namespace
} // namespace pneuma::stages::common
