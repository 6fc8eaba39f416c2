// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/quantity.h"

#include <cstdlib>
#include <cstring>
#include <random>
#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/schema/spelling.h"

// UDUNITS 2.2.28 leaks a name in front of a syntax error.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:utlex";
}

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
                                                      {"9e-5 K-1", "K-1", 9e-5},
                                                      {"9e-5 K^-1", "K-1", 9e-5},
                                                      {"9e-5 K⁻¹", "K-1", 9e-5},
                                                      {"90 ppm/K", "K-1", 9e-5},
                                                      {"9e-5 1/degC", "K-1", 9e-5},
                                                      {"1750 kg/m^3", "kg/m3", 1750},
                                                      {"1750 kg/m**3", "kg/m3", 1750},
                                                      {"1750 kg/m³", "kg/m3", 1750},
                                                      {"1750 kg m-3", "kg/m3", 1750},
                                                      {"16.6 N/mm²", "Pa", 16.6e6},
                                                      {"5 Pa·s", "Pa s", 5},
                                                      {"5 Hz", "1/s", 5},
                                                      {"5 %/min", "1/s", 0.05 / 60},
                                                      {".5 m", "m", 0.5},
                                                      {"5. m", "m", 5},
                                                      {"250\u00a0um", "m", 0.00025},
                                                      {"250\u202fum", "m", 0.00025},
                                                      {"250\tum\n", "m", 0.00025},
                                                      {"\u22125 Pa", "Pa", -5},
                                                      {"5 Bar", "Pa", 5e5},
                                                      {"5 mPa", "Pa", 0.005}}) {
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
           {"250", "m", "`250` has no unit; expected a length such as `250 um` or `6 m`"},
           {"0.3", "1", "`0.3` has no unit; expected a ratio such as `0.3 %`"},
           {"um", "m", "`um` does not begin with a number; expected a length such as `250 um` or `6 m`"},
           {"", "m", "`` does not begin with a number; expected a length such as `250 um` or `6 m`"},
           {"5 1/m", "m", "`5 1/m` has a unit of another kind; expected a length such as `250 um` or `6 m`"},
           {"5 kPa", "m", "`5 kPa` has a unit of another kind; expected a length such as `250 um` or `6 m`"},
           {"5 10 m", "m", "`5 10 m` has a unit that begins with a digit; expected a length such as `250 um` or `6 m`"},
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
            "`1e999 Pa` has a number too large or too small to be held; expected a pressure or stress such as `400 "
            "Pa`"},
           {"1e300 km", "um", "`1e300 km` is too large; expected a quantity in um such as `1 um`"},
           {"1 K @ 5", "K", "`1 K @ 5` has a number in its unit; did you mean `1 K`?"}}) {
    EXPECT_EQ(parse_quantity(bad.text, bad.unit).error, bad.message);
  }
}

TEST(Quantity, ColumnsOfWaterAndPoundsPerSquareFootArePressures) {
  for (const Good& good : std::initializer_list<Good>{{"1 psf", "Pa", 4.4482216152605 / (0.3048 * 0.3048)},
                                                      {"1 mmH2O", "Pa", 9.80665},
                                                      {"1 inH2O", "Pa", 249.08891},
                                                      {"1 cmH2O", "Pa", 98.0665},
                                                      {"1 mm H2O", "Pa", 9.80665},
                                                      {"1 kPa/mmH2O", "1", 1000 / 9.80665},
                                                      {"1 mmH2O2/mmH2O", "Pa", 9.80665},
                                                      {"1 inch_H2O_39F", "Pa", 249.08193551052}}) {
    const Quantity read = parse_quantity(good.text, good.unit);
    EXPECT_EQ(read.error, "") << good.text;
    EXPECT_DOUBLE_EQ(read.value, good.value) << good.text;
  }
}

TEST(Quantity, WhatWasLikelyMeantIsSaid) {
  struct Odd {
    const char* text;
    const char* unit;
    const char* rest; // of the message
  };
  for (const Odd& odd : std::initializer_list<Odd>{
           {"1'000 MPa", "Pa", "has a `'` in its number; did you mean `1000 MPa`?"},
           {"1\u2019000 MPa", "Pa", "has a `'` in its number; did you mean `1000 MPa`?"},
           {"1_000 MPa", "Pa", "has a `_` in its number; did you mean `1000 MPa`?"},
           {"1 000 MPa", "Pa", "has a blank in its number; did you mean `1000 MPa`?"},
           {"1\u202f000 MPa", "Pa", "has a blank in its number; did you mean `1000 MPa`?"},
           {"1 000 000,5 Pa", "Pa", "has a blank in its number; did you mean `1000000.5 Pa`?"},
           {"0,5 m", "m", "has a decimal comma; did you mean `0.5 m`?"},
           {"-0,500 kPa", "Pa", "has a decimal comma; did you mean `-0.500 kPa`?"},
           {",5 m", "m", "has a decimal comma; did you mean `.5 m`?"},
           {"1,5e3 Pa", "Pa", "has a decimal comma; did you mean `1.5e3 Pa`?"},
           {"1,000 MPa", "Pa", "has a decimal comma; did you mean `1.000 MPa` or `1000 MPa`?"},
           {"1.000,5 MPa", "Pa", "has a decimal comma; did you mean `1000.5 MPa`?"},
           {"1,000.5 MPa", "Pa", "has a `,` in its number; did you mean `1000.5 MPa`?"},
           {"1,000,000 Pa", "Pa", "has a `,` in its number; did you mean `1000000 Pa`?"},
           {"1.000.000 Pa", "Pa", "has an odd number; did you mean `1000000 Pa`?"},
           {"1.2.3 m", "m", "has an odd number; expected a length such as `250 um` or `6 m`"},
           {"1e3e3 Pa", "Pa", "has an odd number; expected a pressure or stress such as `400 Pa`"},
           {"+-400 Pa", "Pa", "has an odd sign; did you mean `400 Pa` or `-400 Pa`?"},
           {"± 5 Pa", "Pa", "has an odd sign; did you mean `5 Pa` or `-5 Pa`?"},
           {"--5 Pa", "Pa", "has an odd sign; did you mean `5 Pa` or `-5 Pa`?"},
           {"- 5 Pa", "Pa", "has an odd sign; did you mean `-5 Pa`?"},
           {"+ 5 Pa", "Pa", "has an odd sign; did you mean `5 Pa`?"},
           {"3 m 20", "m", "has a number in its unit; did you mean `3.2 m`?"},
           {"6 m 50", "m", "has a number in its unit; did you mean `6.5 m`?"},
           {"6 m50", "m", "has a number in its unit; did you mean `6.5 m`?"},
           {"5 m 3 m", "m", "has a number in its unit; did you mean `5 m`?"},
           {"-3 m 05", "m", "has a number in its unit; did you mean `-3.05 m`?"},
           {"3 m 20 cm", "m", "has a number in its unit; did you mean `3.2 m`?"},
           {"5 ft 6 in", "m", "has a number in its unit; did you mean `1.6764 m`?"},
           {"30°15'", "rad", "has a number in its unit; did you mean `30.25 deg`?"},
           {"30° 15' 36\"", "rad", "has a number in its unit; did you mean `30.26 deg`?"},
           {"200 um 2", "m", "has a number in its unit; did you mean `200 um`?"},
           {"200 um 2", "m2", "has a number in its unit; did you mean `200 um2`?"},
           {"16 N/mm 2", "Pa", "has a number in its unit; did you mean `16 N/mm2`?"},
           {"4 m/2", "m", "has a number in its unit; did you mean `2 m`?"},
           {"400 kPa * 2", "Pa", "has a number in its unit; did you mean `800000 Pa`?"},
           {"1/2 m", "m", "has a number in its unit; did you mean `0.5 m`?"},
           {"0.6 %/2", "1", "has a number in its unit; did you mean `0.3 %`?"},
           {"0.5 pi rad", "rad", "has a number in its unit; did you mean `90 deg`?"},
           {"5 % Pa", "Pa", "has a number in its unit; did you mean `0.05 Pa`?"},
           {"400 Pa after 100", "Pa", "has a number in its unit; did you mean `400 Pa`?"},
           {"400 Pa ref 100", "Pa", "has a number in its unit; did you mean `400 Pa`?"},
           {"400 Pa AFTER2", "Pa", "has a number in its unit; did you mean `400 Pa`?"},
           {"5 m ± 1 mm", "m", "has a number in its unit; did you mean `5 m`?"},
           {"5-6 m", "m", "has a number in its unit; expected a length such as `250 um` or `6 m`"},
           {"5 s since 1990-01-01", "s", "has a number in its unit; did you mean `5 s`?"},
           {"400 mpa", "Pa", "has the unknown unit `mpa`; did you mean `400 MPa`?"},
           {"400 PA", "Pa", "has a unit of another kind; did you mean `400 Pa`?"},
           {"16 n/MM^2", "Pa", "has the unknown unit `n/MM^2`; did you mean `16 N/mm2`?"},
           {"5 Kn/m", "N/m", "has the unknown unit `Kn/m`; did you mean `5 kN/m`?"},
           {"5 Mm", "m", "has the odd unit `Mm`; did you mean `5 mm`?"},
           {"5 S", "s", "has a unit of another kind; did you mean `5 s`?"},
           {"5 k Pa", "Pa", "has the unknown unit `k Pa`; did you mean `5 kPa`?"},
           {"23 deg C", "K", "has a unit of another kind; did you mean `23 degC`?"},
           {"73 F", "K", "has a unit of another kind; did you mean `73 degF`?"},
           {"50 kg/m2", "Pa", "has a unit of another kind; did you mean `50 kgf/m2`?"},
           {"5 lg(re Pa)", "Pa", "has a unit of another kind; expected a pressure or stress such as `400 Pa`"},
           {"5 lg(re m/m)", "1", "has a unit of another kind; expected a ratio such as `0.3 %`"},
           {"5 dB", "1", "has the unknown unit `dB`; expected a ratio such as `0.3 %`"}}) {
    EXPECT_EQ(parse_quantity(odd.text, odd.unit).error, fmt::format("`{}` {}", odd.text, odd.rest));
  }
}

// Every unit of a list with every way to hide a number in it, all of which UDUNITS reads or may come to read.
TEST(Quantity, UnitHoldsNoNumber) {
  for (const auto& [name, unit] : std::initializer_list<std::pair<const char*, const char*>>{
           {"m", "m"},     {"um", "m"},      {"mm", "m"},          {"ft", "m"},     {"Pa", "Pa"},    {"N/mm2", "Pa"},
           {"MPa", "Pa"},  {"mmH2O", "Pa"},  {"kN/m2", "Pa"},      {"N/m/m", "Pa"}, {"kN/m", "N/m"}, {"K", "K"},
           {"degC", "K"},  {"deg", "rad"},   {"°", "rad"},         {"%", "1"},      {"mm/m", "1"},   {"kg/m3", "kg/m3"},
           {"K-1", "K-1"}, {"ppm/K", "K-1"}, {"kg/m**3", "kg/m3"}, {"d", "s"},      {"1/s", "1/s"},  {"m³", "m3"}}) {
    ASSERT_EQ(parse_quantity(fmt::format("7 {}", name), unit).error, "");
    for (const char* way :
         {"{} 2",      "{} 20",      "{}\t2",      "{} 1e3",    "{}*2",        "{}**2.5",   "{}/2",          "{}.2",
          "{}·2",      "{} 2.5",     "{}^2.5",     "{}2.5",     "{}20",        "{}0",       "{}1",           "{}+1",
          "{}^1",      "{} -2",      "{} +2",      "{}--2",     "2 {}",        "2{}",       "-2 {}",         "+2 {}",
          "2.5 {}",    "1e3 {}",     "10^3 {}",    ".5 {}",     "2*{}",        "1/2 {}",    "/2 {}",         "1/1/{}",
          "({})*2",    "(2 {})",     "(({} 2))",   "{} (2)",    "(2) {}",      "{}/(2)",    "{} @ 2",        "{}@2",
          "{} from 2", "{} after 2", "{} since 2", "{} ref 2",  "{} AFTER 2",  "{} ref2",   "{} after -2",   "({} @ 2)",
          "{} per 2",  "{} per2",    "2 per {}",   "{} %",      "% {}",        "{}/%",      "percent {}",    "{} pi",
          "pi {}",     "{}\u00a02",  "{}²5",       "{}\u202f2", "lg(re 2 {})", "ln(re {})", "{} 1990-01-01", "'000 {}",
          "_000 {}",   ",000 {}",    "{}, 2",      "{} ± 2",    "{} +- 2",     "{} 2 {}"}) {
      const std::string text = fmt::format("7 {}", fmt::format(fmt::runtime(way), name, name));
      const std::string error = parse_quantity(text, unit).error;
      EXPECT_TRUE(error.starts_with("`")) << text << ": " << error;
      EXPECT_EQ(error.find(';'), error.rfind(';')) << error; // one message
    }
  }
}

TEST(Quantity, ExampleOfTheKeyStandsInTheMessage) {
  EXPECT_EQ(parse_quantity("6", "m", "6 m").error, "`6` has no unit; expected a length such as `6 m`");
  EXPECT_EQ(parse_quantity("6", "kN m").error, "`6` has no unit; expected a quantity in kN m such as `1 kN m`");
}

TEST(Quantity, LongOrUnprintableTextIsNeitherReadNorPrinted) {
  EXPECT_EQ(parse_quantity("5 " + std::string(1 << 20, '('), "m").error,
            "`5 " + std::string(58, '(') +
                "...` is longer than 200 characters; expected a length such as `250 um` or "
                "`6 m`");
  EXPECT_THAT(parse_quantity("5 " + std::string(150, '('), "m").error, testing::StartsWith("`5 ((((")); // no overflow
  EXPECT_LT(parse_quantity("5 " + std::string(150, 'x'), "m").error.size(), 200U);
  std::string umlauts = "5 ";
  for (int i = 0; i < 40; ++i) umlauts += "ü"; // never cut in two
  EXPECT_THAT(parse_quantity("x" + umlauts, "m").error, testing::HasSubstr("ü...`"));
  EXPECT_THAT(parse_quantity(umlauts, "m").error, testing::HasSubstr("ü...`"));
  EXPECT_EQ(parse_quantity(std::string_view("5 m\0 2", 6), "m").error,
            "`5 m? 2` holds a control character; expected a length such as `250 um` or `6 m`");
  EXPECT_EQ(parse_quantity("5\x1b[1m", "m").error,
            "`5?[1m` holds a control character; expected a length such as `250 um` or `6 m`");
}

// The texts in backquotes behind "did you mean".
std::vector<std::string> guesses_in(const std::string& error) {
  std::vector<std::string> result;
  std::size_t at = error.rfind("; did you mean ");
  if (at == std::string::npos) return result;
  while ((at = error.find('`', at)) != std::string::npos) {
    const std::size_t end = error.find('`', at + 1);
    result.push_back(error.substr(at + 1, end - at - 1));
    at = end + 1;
  }
  return result;
}

// One number, then a unit without digits once its exponents and a leading 1/ are taken off; written with other means
// than the code's own.
bool holds_one_number(std::string text, const std::string& unit) {
  static const std::regex number_and_unit(R"( *[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)? *(1?/)?(.*\S) *)");
  static const std::regex exponent(R"(([A-Za-z)])(\^|\*\*)?(\+?[2-9]|-[1-9])(?!\d))");
  static const std::regex number_or_offset(R"([0-9@,;_]|\b(after|from|since|ref|lg)\b)");
  for (const auto& [from, to] : std::initializer_list<std::pair<const char*, const char*>>{
           {"\u00a0", " "}, {"²", "2"}, {"³", "3"}, {"⁻¹", "-1"}, {"mmH2O", "water"}}) {
    for (std::size_t at = 0; (at = text.find(from)) != std::string::npos;) text.replace(at, std::strlen(from), to);
  }
  std::smatch parts;
  if (!std::regex_match(text, parts, number_and_unit)) return false;
  if (unit == "1" && parts[4] == "1") return true;
  return !std::regex_search(std::regex_replace(parts[4].str(), exponent, "$1"), number_or_offset);
}

TEST(Quantity, WhatIsReadHasOneNumberAndAUnitWithoutAny) {
  const std::vector<std::string> pieces = {
      "5",       "0.25",   "-3",      "1e3",   "2",     "20",     "000", "1",   "+",   "-",     "±",   ",",   ".", "'",
      "_",       " ",      " ",       " ",     " ",     "\u00a0", "/",   "1/",  "*",   "**",    "^",   "(",   ")", "@",
      " after ", " from ", " since ", " ref ", " per ", "lg(re ", "m",   "um",  "mm",  "Pa",    "kPa", "MPa", "N", "kN",
      "K",       "degC",   "deg",     "rad",   "°",     "%",      "ppm", "pi",  "kg",  "mmH2O", "psf", "s",   "²", "³",
      "⁻¹",      "e3",     "-1",      "PA",    "m2",    "mm2",    "m3",  "K-1", "nan", "inf",   "x",   "·"};
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::vector<std::string> kinds = {"m", "Pa", "K", "rad", "1", "N/m", "K-1", "kg/m3"};
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string& kind = kinds[below(kinds.size())];
    std::string text = i % 4 == 0 ? "" : i % 4 == 1 ? "5 " : "5 " + kind;
    for (std::size_t n = 1 + below(3); n > 0; --n) text += pieces[below(pieces.size())];
    const Quantity read = parse_quantity(text, kind);
    EXPECT_LT(read.error.size(), 300U);
    for (const std::string& guess : guesses_in(read.error)) EXPECT_EQ(parse_quantity(guess, kind).error, "") << text;
    if (!read.error.empty()) continue;
    ++accepted;
    EXPECT_TRUE(holds_one_number(text, kind)) << text << " as " << kind;
    if (kind == "K") continue; // degC has an offset
    char* end = nullptr;
    const double number = std::strtod(text.c_str() + text.find_first_of("+-.0123456789"), &end);
    EXPECT_DOUBLE_EQ(read.value, number * parse_quantity("1 " + std::string(end), kind).value) << text;
  }
  EXPECT_GT(accepted, 300);
}

TEST(Quantity, TextReadsBackToTheSameBits) {
  for (const double value : {0.1, 1.0 / 3, 2.5e-4, 890.0, 6.02e23, -0.6e3, 5e-324, 0.0}) {
    const Quantity read = parse_quantity(quantity_text(value, "N/m"), "N/m");
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(read.value, value);
  }
}

TEST(Quantity, ValueThatWasTakenIsShown) {
  EXPECT_EQ(shown(parse_quantity("400 kPa", "Pa").value, "Pa"), "400000 Pa");
  EXPECT_EQ(shown(0.25, "m"), "0.25 m");
  EXPECT_EQ(shown(1.0 / 3, "m3"), "0.333333 m3");
  EXPECT_EQ(shown(9e8, "Pa"), "9e+08 Pa");
  EXPECT_EQ(shown(296.15, "K"), "296.15 K (23 degC)");
  EXPECT_EQ(shown(parse_quantity("30 deg", "rad").value, "rad"), "0.523599 rad (30 deg)");
  EXPECT_EQ(shown(0.003, "1"), "0.003 (0.3 %)");
}

TEST(Quantity, RatioIsReadAsOneToo) {
  for (const double value : {0.003, 1.0 / 3, 0.0}) {
    const Quantity read = parse_quantity(quantity_text(value, "1"), "1");
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(read.value, value);
  }
  EXPECT_EQ(parse_quantity("3 1", "m").error,
            "`3 1` has a unit that begins with a digit; expected a length such as `250 um` or `6 m`");
}

TEST(Number, FillsTheWholeText) {
  EXPECT_EQ(parse_number("0.45"), 0.45);
  EXPECT_EQ(parse_number("1e-3"), 1e-3);
  EXPECT_FALSE(parse_number("0.45 m"));
  EXPECT_FALSE(parse_number("inf"));
  EXPECT_FALSE(parse_number("+-5"));
  EXPECT_EQ(parse_number("+5"), 5);
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
