// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/law_at.h"

#include <stdexcept>

#include "tests/unit/pipeline/workflow/example.h"

namespace pneuma::stages::common {
namespace {

using pipeline::workflow::J2Law;
using pipeline::workflow::Material;

constexpr const char* warm =
    ", temperature: [{at: 0 degC, E: 1 GPa, hardening: [{stress: 20 MPa, modulus: 80 MPa}, {stress: 27 MPa, modulus: "
    "40 MPa}]}, {at: 53 degC, E: 600 MPa}]";

// The foil of the example, which yields, with more keys.
Material foil_with(const std::string& keys) {
  const std::string j2 =
      "law: j2, E: 900 MPa, nu: 0.45, hardening: [{stress: 15 MPa, modulus: 72 MPa}, {stress: 21 MPa, "
      "modulus: 40 MPa}]";
  const pipeline::workflow::Folder folder;
  const std::string text =
      pipeline::workflow::replaced(pipeline::workflow::example, "law: elastic, E: 900 MPa, nu: 0.45", j2 + keys);
  return pipeline::workflow::read_workflow(folder.write("w.yaml", text)).workflow.materials.at("etfe");
}

TEST(LawAt, IsLinearBetweenTwoTemperatures) {
  const Material material = foil_with(warm);
  const auto at = [&](double degC) { return std::get<J2Law>(law_at(material, 273.15 + degC)); };
  EXPECT_DOUBLE_EQ(at(11.5).E, 0.95e9);
  EXPECT_DOUBLE_EQ(at(11.5).hardening[0].stress, 17.5e6);
  EXPECT_DOUBLE_EQ(at(11.5).hardening[0].modulus, 76e6);
  EXPECT_NEAR(at(38).E, 0.75e9, 1e-3);         // to rounding of the temperatures
  EXPECT_EQ(at(38).hardening[1].stress, 21e6); // left out: as in the law itself
  EXPECT_EQ(law_at(material, 296.15).index(), material.law.index());
  EXPECT_EQ(std::get<J2Law>(law_at(material, 296.15)).E, 9e8); // at its own temperature the law itself
  EXPECT_EQ(at(0).E, 1e9);
  const std::array<double, 2> range = *temperatures_of(material);
  EXPECT_EQ(range[0], 273.15);
  EXPECT_DOUBLE_EQ(range[1], 326.15);
  EXPECT_THROW(law_at(material, 272), std::invalid_argument);
  EXPECT_THROW(law_at(material, 327), std::invalid_argument);
}

TEST(LawAt, WithoutATableDoesNotDependOnTheTemperature) {
  const Material material = foil_with("");
  EXPECT_FALSE(temperatures_of(material));
  EXPECT_EQ(std::get<J2Law>(law_at(material, 200)).E, 9e8);
}

} // namespace
} // namespace pneuma::stages::common
