// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/quantity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::schema {
namespace {

struct Good {
  const char* text;
  const char* unit;
  double value;
};

TEST(Quantity, IsConvertedToTheNearestDouble) {
  for (const Good& good : std::initializer_list<Good>{{"250 um", "m", 0.00025},
                                                      {"250um", "m", 0.00025},
                                                      {"250 µm", "m", 0.00025},
                                                      {"0.3 mm", "m", 0.0003},
                                                      {"0.89 kN/m", "N/m", 890},
                                                      {"-0.6 kPa", "Pa", -600},
                                                      {"+5 Pa", "Pa", 5},
                                                      {"900 MPa", "Pa", 9e8},
                                                      {"16.6 N/mm2", "Pa", 16.6e6},
                                                      {"1 bar", "Pa", 1e5},
                                                      {"1e-3 m3", "m3", 1e-3},
                                                      {"1750 kg/m3", "kg/m3", 1750},
                                                      {"3 d", "s", 259200},
                                                      {"0.3 %", "1", 0.003},
                                                      {"9e-5 /K", "K-1", 9e-5},
                                                      {"9e-5 1/K", "K-1", 9e-5},
                                                      {"9e-5 K-1", "K-1", 9e-5}}) {
    const Quantity read = parse_quantity(good.text, good.unit);
    EXPECT_EQ(read.error, "") << good.text;
    EXPECT_DOUBLE_EQ(read.value, good.value) << good.text;
  }
  EXPECT_EQ(parse_quantity("250 um", "m").value, 0.00025); // to the last bit
}

TEST(Quantity, TemperatureInCelsiusHasItsOffset) {
  EXPECT_DOUBLE_EQ(parse_quantity("23 degC", "K").value, 296.15);
  EXPECT_DOUBLE_EQ(parse_quantity("-40 degC", "K").value, 233.15);
  EXPECT_EQ(parse_quantity("296.15 K", "K").value, 296.15);
}

TEST(Quantity, AngleInDegreesOrRadians) {
  EXPECT_DOUBLE_EQ(parse_quantity("180 deg", "rad").value, 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(parse_quantity("180°", "rad").value, 3.14159265358979323846);
  EXPECT_EQ(parse_quantity("0.5 rad", "rad").value, 0.5);
}

TEST(Quantity, WhatIsWrongIsSaid) {
  struct Bad {
    const char* text;
    const char* unit;
    const char* message;
  };
  for (const Bad& bad : std::initializer_list<Bad>{
           {"250", "m", "`250` has no unit; expected a length such as `250 um`"},
           {"um", "m", "`um` does not begin with a number; expected a length such as `250 um`"},
           {"", "m", "`` does not begin with a number; expected a length such as `250 um`"},
           {"5 1/m", "m", "`5 1/m` has a unit of another kind; expected a length such as `250 um`"},
           {"5 kPa", "m", "`5 kPa` has a unit of another kind; expected a length such as `250 um`"},
           {"5 10 m", "m", "`5 10 m` has a unit that begins with a digit; expected a length such as `250 um`"},
           {"23 C", "K",
            "`23 C` is in coulomb: the unit of temperature is degC or K; expected a temperature such as `23 degC`"},
           {"5 parsecs per fortnight", "Pa",
            "`5 parsecs per fortnight` has a unit of another kind; expected a pressure or stress such as `400 Pa`"},
           {"5 pascall", "Pa",
            "`5 pascall` has the unknown unit `pascall`; expected a pressure or stress such as `400 Pa`"},
           {"30 %", "rad", "`30 %` has a unit of another kind; expected an angle such as `30 deg`"},
           {"30 deg", "1", "`30 deg` has a unit of another kind; expected a ratio such as `0.3 %`"},
           {"nan Pa", "Pa", "`nan Pa` does not begin with a number; expected a pressure or stress such as `400 Pa`"},
           {"1e999 Pa", "Pa",
            "`1e999 Pa` does not begin with a number; expected a pressure or stress such as `400 Pa`"},
           {"1 K @ 5", "K", "`1 K @ 5` has an odd unit; expected a temperature such as `23 degC`"}}) {
    EXPECT_EQ(parse_quantity(bad.text, bad.unit).error, bad.message);
  }
}

TEST(Quantity, TextReadsBackToTheSameBits) {
  for (const double value : {0.1, 1.0 / 3, 2.5e-4, 890.0, 6.02e23, -0.6e3, 5e-324, 0.0}) {
    const Quantity read = parse_quantity(quantity_text(value, "N/m"), "N/m");
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(read.value, value);
  }
}

TEST(Quantity, RatioIsReadAsOneToo) {
  for (const double value : {0.003, 1.0 / 3, 0.0}) {
    const Quantity read = parse_quantity(quantity_text(value, "1"), "1");
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(read.value, value);
  }
  EXPECT_EQ(parse_quantity("3 1", "m").error,
            "`3 1` has a unit that begins with a digit; expected a length such as `250 um`");
}

TEST(Number, FillsTheWholeText) {
  EXPECT_EQ(parse_number("0.45"), 0.45);
  EXPECT_EQ(parse_number("1e-3"), 1e-3);
  EXPECT_FALSE(parse_number("0.45 m"));
  EXPECT_FALSE(parse_number("inf"));
  EXPECT_FALSE(parse_number(""));
}

TEST(Spelling, NearestWordIsFoundAndAFarOneIsNot) {
  const std::vector<std::string> known = {"thickness", "material", "name"};
  EXPECT_EQ(nearest("thicknes", known), "thickness");
  EXPECT_EQ(nearest("Thikcness", known), "thickness");
  EXPECT_EQ(nearest("mterial", known), "material");
  EXPECT_EQ(nearest("colour", known), "");
  EXPECT_EQ(suggestion("nmae", known), "; did you mean `name`?");
}

} // namespace
} // namespace pneuma::pipeline::schema
