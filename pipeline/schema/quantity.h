// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pneuma::pipeline::schema {

// A quantity as the user wrote it, in SI; or what is wrong with it.
struct Quantity {
  double value = 0;  // in the wanted unit
  std::string error; // empty: fine; otherwise a sentence that begins with what was written
};

// Reads "250 um" as a quantity of the dimension of `unit` (SI: "m", "Pa", "K", "rad", ...) and converts it to `unit`.
// Number and unit are read apart, so that "23 degC" is 296.15 K; the unit's ratio to the wanted one must be a pure
// number, so that "5 1/m" is no length. Units are those of UDUNITS-2, and psf, mmH2O and inH2O; a unit holds no number
// but exponents and a leading "1/", so that "3 m 20" is not 60 m. The error says what was likely meant, or else names
// `example`, a good value of the key (empty: one of the dimension).
Quantity parse_quantity(std::string_view text, const std::string& unit, const std::string& example = "");

// A value in SI that was taken, for messages: "400000 Pa", "296.15 K (23 degC)", "0.523599 rad (30 deg)", "0.003 (0.3
// %)".
std::string shown(double value, const std::string& unit);

// The shortest text that reads back to the same double, "0.00025 m".
std::string quantity_text(double value, const std::string& unit);

// A temperature in degC, for messages.
inline double celsius(double kelvin) {
  return kelvin - 273.15;
}

// "a length", "a pressure": what `unit` measures, with an article.
std::string dimension_of(const std::string& unit);

// A plain finite number that fills all of the text.
std::optional<double> parse_number(std::string_view text);

} // namespace pneuma::pipeline::schema
