// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/quantity.h"

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <udunits2.h>

namespace pneuma::pipeline::schema {

namespace {

using Unit = std::unique_ptr<ut_unit, decltype(&ut_free)>;

Unit own(ut_unit* unit) {
  return {unit, &ut_free};
}

// The database of units, read once.
ut_system* units() {
  static const std::unique_ptr<ut_system, decltype(&ut_free_system)> system = [] {
    ut_set_error_message_handler(ut_ignore);
    std::unique_ptr<ut_system, decltype(&ut_free_system)> read(ut_read_xml(nullptr), &ut_free_system);
    if (!read) throw std::runtime_error("the units of UDUNITS-2 cannot be read; is libudunits2-data installed?");
    const Unit degree = own(ut_parse(read.get(), "°", UT_UTF8));
    if (degree) ut_map_name_to_unit("deg", UT_ASCII, degree.get());
    return read;
  }();
  return system.get();
}

// number_end: where the number ends; 0: there is none
std::size_t read_number(std::string_view text, double& value) {
  const std::size_t sign = !text.empty() && text.front() == '+' ? 1 : 0;
  const auto [end, failure] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
  if (failure != std::errc() || !std::isfinite(value)) return 0;
  return static_cast<std::size_t>(end - text.data());
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// A factor below one is applied by division where its inverse is whole: 250 um is 250 / 1e6, the double nearest to
// 0.00025, while 250 * 1e-6 may miss it by a bit.
double convert(double value, const ut_unit* from, const ut_unit* to) {
  const std::unique_ptr<cv_converter, decltype(&cv_free)> converter(
      ut_get_converter(const_cast<ut_unit*>(from), const_cast<ut_unit*>(to)), &cv_free);
  const double offset = cv_convert_double(converter.get(), 0);
  if (offset != 0) return cv_convert_double(converter.get(), value);
  const double factor = cv_convert_double(converter.get(), 1);
  const double inverse = std::round(1 / factor);
  if (factor < 1 && inverse < 1e15 && std::abs(inverse * factor - 1) < 1e-14) return value / inverse;
  return value * factor;
}

// UDUNITS counts the radian as dimensionless: an angle and a ratio are told apart by name.
bool is_pure_number(const ut_unit* ratio) {
  std::array<char, 128> text{};
  return ratio != nullptr && ut_is_dimensionless(ratio) != 0 &&
         ut_format(ratio, text.data(), text.size(), UT_ASCII | UT_DEFINITION) >= 0 &&
         std::string_view(text.data()).find("rad") == std::string_view::npos;
}

std::string example(const std::string& unit) {
  if (unit == "m") return "250 um";
  if (unit == "m3") return "0.5 m3";
  if (unit == "Pa") return "400 Pa";
  if (unit == "N/m") return "0.89 kN/m";
  if (unit == "K") return "23 degC";
  if (unit == "rad") return "30 deg";
  if (unit == "s") return "5 s";
  if (unit == "N") return "1 kN";
  if (unit == "kg/m3") return "1750 kg/m3";
  if (unit == "K-1") return "9e-5 K-1";
  if (unit == "1") return "0.3 %";
  return "1 " + unit;
}

} // namespace

std::string dimension_of(const std::string& unit) {
  if (unit == "m") return "a length";
  if (unit == "m3") return "a volume";
  if (unit == "Pa") return "a pressure or stress";
  if (unit == "N/m") return "a force per length";
  if (unit == "K") return "a temperature";
  if (unit == "rad") return "an angle";
  if (unit == "s") return "a time";
  if (unit == "N") return "a force";
  if (unit == "kg/m3") return "a density";
  if (unit == "K-1") return "a thermal expansion";
  if (unit == "1") return "a ratio";
  return "a quantity in " + unit;
}

Quantity parse_quantity(std::string_view text, const std::string& unit) {
  const std::string wanted = fmt::format("expected {} such as `{}`", dimension_of(unit), example(unit));
  const auto wrong = [&](const std::string& what) {
    return Quantity{0, fmt::format("`{}` {}; {}", text, what, wanted)};
  };

  double number = 0;
  const std::string_view whole = trimmed(text);
  const std::size_t end = read_number(whole, number);
  if (end == 0) return wrong("does not begin with a number");
  std::string name(trimmed(whole.substr(end)));
  if (name.empty()) return wrong("has no unit");
  if (name == "C") return wrong("is in coulomb: the unit of temperature is degC or K");
  if (name.front() == '/') name = fmt::format("1{}", name);
  const bool reciprocal = name.size() > 2 && name.starts_with("1/");
  const bool is_one = unit == "1" && name == "1"; // how a ratio is written to the last bit
  const bool digit_first = (name.front() >= '0' && name.front() <= '9') || name.front() == '.';
  if (digit_first && !reciprocal && !is_one) return wrong("has a unit that begins with a digit");
  if (name.find('@') != std::string::npos || name.find(" from ") != std::string::npos) return wrong("has an odd unit");

  const Unit read = own(ut_parse(units(), name.c_str(), UT_UTF8));
  if (!read) return wrong(fmt::format("has the unknown unit `{}`", name));
  const Unit target = own(ut_parse(units(), unit.c_str(), UT_UTF8));
  const Unit ratio = own(ut_divide(read.get(), target.get()));
  if (!is_pure_number(ratio.get())) return wrong("has a unit of another kind");
  const double value = convert(number, read.get(), target.get());
  if (!std::isfinite(value)) return wrong("is too large");
  return {value, {}};
}

std::string quantity_text(double value, const std::string& unit) {
  return fmt::format("{} {}", value, unit);
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const std::size_t end = read_number(text, value);
  if (end == 0 || end != text.size()) return std::nullopt;
  return value;
}

} // namespace pneuma::pipeline::schema
