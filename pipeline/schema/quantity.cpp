// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <udunits2.h>

namespace pneuma::pipeline::schema {

namespace {

constexpr std::size_t longest = 200; // bytes of a quantity: the parser of UDUNITS recurses into parentheses
constexpr const char* digits = "0123456789";
constexpr const char* marks = ".,'_ "; // what people put between digits

using Unit = std::unique_ptr<ut_unit, decltype(&ut_free)>;

Unit own(ut_unit* unit) {
  return {unit, &ut_free};
}

struct Dimension {
  std::string unit, name, example;
};

Dimension dimension_in(const std::string& unit) {
  static const std::array<Dimension, 11> known = {{{"m", "a length", "250 um` or `6 m"},
                                                   {"m3", "a volume", "0.5 m3"},
                                                   {"Pa", "a pressure or stress", "400 Pa"},
                                                   {"N/m", "a force per length", "0.89 kN/m"},
                                                   {"K", "a temperature", "23 degC"},
                                                   {"rad", "an angle", "30 deg"},
                                                   {"s", "a time", "5 s"},
                                                   {"N", "a force", "1 kN"},
                                                   {"kg/m3", "a density", "1750 kg/m3"},
                                                   {"K-1", "a thermal expansion", "9e-5 K-1"},
                                                   {"1", "a ratio", "0.3 %"}}};
  const auto* const found =
      std::find_if(known.begin(), known.end(), [&](const Dimension& d) { return unit == d.unit; });
  return found != known.end() ? *found : Dimension{unit, "a quantity in " + unit, "1 " + unit};
}

// The database of units, read once, and what it lacks; columns of water are the conventional ones (1000 kg/m3, 9.80665
// m/s2) of NIST SP 811 (2008), appendix B.8.
ut_system* units() {
  static const std::unique_ptr<ut_system, decltype(&ut_free_system)> system = [] {
    ut_set_error_message_handler(ut_ignore);
    std::unique_ptr<ut_system, decltype(&ut_free_system)> read(ut_read_xml(nullptr), &ut_free_system);
    if (!read) throw std::runtime_error("the units of UDUNITS-2 cannot be read; is libudunits2-data installed?");
    const Unit degree = own(ut_parse(read.get(), "°", UT_UTF8));
    if (degree) ut_map_name_to_unit("deg", UT_ASCII, degree.get());
    using Definition = std::pair<const char*, const char*>;
    for (const auto& [symbol, value] :
         {Definition("psf", "lbf/ft2"), Definition("mmH2O", "9.80665 Pa"), Definition("inH2O", "249.08891 Pa")}) {
      const Unit unit = own(ut_parse(read.get(), value, UT_ASCII));
      if (unit) ut_map_symbol_to_unit(symbol, UT_ASCII, unit.get());
    }
    return read;
  }();
  return system.get();
}

Unit parse_unit(std::string_view name) {
  return own(ut_parse(units(), std::string(name).c_str(), UT_UTF8));
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_control(char c) {
  return (c >= 0 && c < ' ') || c == 127;
}

// Without capitals and without the ^ of exponents: units that differ by no more are taken for each other.
std::string folded(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c != '^') result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return result;
}

// `pairs`: what is replaced, by what, ...
std::string replaced(std::string_view text, std::initializer_list<const char*> pairs) {
  std::string result(text);
  for (const char* const* from = pairs.begin(); from != pairs.end(); from += 2) {
    for (std::size_t at = 0; (at = result.find(from[0], at)) != std::string::npos; at += std::strlen(from[1])) {
      result.replace(at, std::strlen(from[0]), from[1]);
    }
  }
  return result;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// In characters of a keyboard: blanks that do not break, minus, dash, plus-minus, apostrophe, an ordinal as a degree.
std::string typed(std::string_view text) {
  const std::string result = replaced(text, {"\t", " ", "\u00a0", " ", "\u2007", " ",  "\u2009", " ", "\u202f", " ",
                                             "−",  "-", "–",      "-", "±",      "+-", "’",      "'", "º",      "°"});
  return std::string(trimmed(result));
}

// What stands behind the number, exponents as digits.
std::string unit_name(std::string_view text) {
  const std::string name = replaced(trimmed(text), {"⁻", "-", "¹", "1", "²", "2", "³", "3", "·", ".", "⋅", "."});
  return name.starts_with('/') ? "1" + name : name;
}

// Where the number ends; 0: there is none.
std::size_t read_number(std::string_view text, double& value) {
  const std::size_t plus = text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0;
  const auto [end, failure] = std::from_chars(text.data() + plus, text.data() + text.size(), value);
  if (failure != std::errc() || !std::isfinite(value)) return 0;
  return static_cast<std::size_t>(end - text.data());
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

// UDUNITS counts the radian (rad) and logarithms (lg(re 1)) as dimensionless: a ratio is told apart by the name.
bool is_pure_number(const ut_unit* ratio) {
  std::array<char, 128> text{};
  return ratio != nullptr && ut_is_dimensionless(ratio) != 0 &&
         ut_format(ratio, text.data(), text.size(), UT_ASCII | UT_DEFINITION) >= 0 &&
         std::string_view(text.data()).find('r') == std::string_view::npos;
}

// What was written, on one line and short enough for a message.
std::string as_written(std::string_view text) {
  constexpr std::size_t most = 60;
  std::size_t end = std::min(text.size(), most);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80) --end;
  std::string result(text.substr(0, end));
  std::replace_if(result.begin(), result.end(), is_control, '?');
  return fmt::format("`{}{}`", result, end < text.size() ? "..." : "");
}

// The length of a word such as "after" that stands at the end of a text and joins it to a number; 0: there is none.
std::size_t operation_at_end(std::string_view text) {
  std::size_t word = text.size();
  while (word > 0 && is_letter(text[word - 1])) --word;
  const std::string last = folded(text.substr(word));
  const bool joins = last == "after" || last == "from" || last == "since" || last == "ref" || last == "per";
  return joins ? last.size() : 0;
}

// Where a number stands in a unit, npos: nowhere; UDUNITS would multiply or divide by it or take it as an offset. No
// numbers are a leading "1/", the exponents 2 to 9 and -1 to -9, and digits within a name (mmH2O).
std::size_t number_in(std::string_view name) {
  std::size_t at = name.starts_with("1/") ? 2 : 0;
  while ((at = name.find_first_of(digits, at)) != std::string_view::npos) {
    const std::size_t end = std::min(name.find_first_not_of(digits, at), name.size());
    std::string_view before = name.substr(0, at);
    const bool within = at > 0 && end < name.size() && (is_letter(name[at - 1]) || name[at - 1] == '_') &&
                        (is_letter(name[end]) || name[end] == '_');
    const bool minus = before.ends_with('-');
    if (minus || before.ends_with('+')) before.remove_suffix(1);
    if (before.ends_with('^')) before.remove_suffix(1);
    if (before.ends_with("**")) before.remove_suffix(2);
    const bool raised = !before.empty() && (is_letter(before.back()) || before.back() == ')');
    const bool exponent = raised && end == at + 1 && name[at] > (minus ? '0' : '1') && operation_at_end(before) == 0;
    if (!within && !exponent) return at;
    at = end;
  }
  return at;
}

// A name such as % or pi is a number too: it may stand alone or over a unit (ppm/K), but not beside one.
bool holds_named_number(std::string_view name) {
  constexpr const char* between = " .*/()^+-0123456789";
  for (std::size_t at = 0; (at = name.find_first_not_of(between, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(name.find_first_of(between, at), name.size());
    const std::string_view rest = trimmed(name.substr(end));
    const bool alone = at == 0 && (rest.empty() || rest.front() == '/' || rest.starts_with("per "));
    if (!alone && is_pure_number(parse_unit(name.substr(at, end - at)).get())) return true;
    at = end;
  }
  return false;
}

// The unit in use that `name` is, or from which it differs by no more than capitals; empty: none.
std::string common_unit(const std::string& name) {
  constexpr std::array known = {"um",    "mm",   "cm",    "m",     "km",    "in",    "ft",    "yd",    "m3",   "l",
                                "N",     "kN",   "MN",    "mN",    "lbf",   "N/m",   "kN/m",  "N/mm",  "N/cm", "Pa",
                                "hPa",   "kPa",  "MPa",   "mPa",   "GPa",   "N/m2",  "kN/m2", "N/mm2", "bar",  "mbar",
                                "psi",   "ksi",  "psf",   "mmH2O", "cmH2O", "inH2O", "mmHg",  "inHg",  "atm",  "K",
                                "degC",  "degF", "deg",   "rad",   "s",     "ms",    "min",   "h",     "d",    "g/cm3",
                                "kg/m3", "1/s",  "1/min", "1/K",   "K-1",   "ppm/K", "%/K"};
  const auto like = [&](const char* unit) { return folded(unit) == folded(name); };
  if (std::find(known.begin(), known.end(), name) != known.end()) return name;
  const auto* const found = std::find_if(known.begin(), known.end(), like);
  return found == known.end() ? std::string() : *found;
}

// A number with its marks taken for what they likely are: 1'000 for 1000, 1.000,5 for 1000.5, and 1,000 for 1.000 or
// 1000. Nothing where digits do not come in threes.
std::vector<std::string> without_marks(std::string_view number) {
  const std::size_t last = number.find_last_of(marks);
  if (last == std::string_view::npos) return {};
  const bool is_decimal = (number[last] == '.' || number[last] == ',') && number.find(number[last]) == last;
  const std::string_view whole = number.substr(0, is_decimal ? last : number.size());
  const std::string fraction(is_decimal ? number.substr(last + 1) : "");
  std::string joined;
  for (std::size_t from = 0; from <= whole.size();) {
    const std::size_t to = std::min(whole.find_first_of(marks, from), whole.size());
    if (from > 0 && to - from != 3) return {};
    joined += whole.substr(from, to - from);
    from = to + 1;
  }
  if (!is_decimal) return {joined};
  const bool may_be_thousands = fraction.size() == 3 && joined.size() == whole.size() && joined.size() <= 3 &&
                                number[last] == ',' && !joined.empty() && !joined.starts_with('0');
  if (may_be_thousands) return {joined + "." + fraction, joined + fraction};
  return {joined + "." + fraction};
}

// The digits and marks at the beginning, behind signs.
std::string_view marked_number(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of("+- "), text.size()));
  text = text.substr(0, text.find_first_not_of(std::string(marks) + digits));
  return text.substr(0, text.find_last_of(digits) + 1);
}

// What is wrong with the number, which ends at `end` (0: it cannot be read); empty: nothing.
std::string fault_of_number(const std::string& text, std::size_t end) {
  const std::string_view number = marked_number(text);
  if (end == 0) {
    const std::size_t start = number.empty() ? 0 : static_cast<std::size_t>(number.data() - text.data());
    if (start > 1 || (start == 1 && text[0] == ' ')) return "has an odd sign";
    if (number.starts_with(',')) return "has a decimal comma";
    const bool is_read = !number.empty() && is_digit(number[number[0] == '.' ? 1 : 0]);
    return is_read ? "has a number too large or too small to be held" : "does not begin with a number";
  }
  if (end + 1 >= text.size() || !is_digit(text[end + 1])) return {};
  const char mark = text[end];
  if (mark == ',' && number.find_last_of(".,'_") <= number.find(',')) return "has a decimal comma";
  if (mark == ',' || mark == '\'' || mark == '_') return fmt::format("has a `{}` in its number", mark);
  if (mark == '.' || mark == 'e' || mark == 'E') return "has an odd number";
  return mark == ' ' && !without_marks(number).empty() ? "has a blank in its number" : "";
}

// A number of units `name` in `target`; `error`: what is wrong, without what was written.
Quantity in_unit(double number, const std::string& name, const ut_unit* target) {
  const Unit unit = parse_unit(name);
  if (!unit) return {0, fmt::format("has the unknown unit {}", as_written(name))};
  if (!is_pure_number(own(ut_divide(unit.get(), target)).get())) return {0, "has a unit of another kind"};
  const std::string common = common_unit(name);
  const bool is_strange = !common.empty() && ut_compare(unit.get(), parse_unit(common).get()) != 0;
  if (is_strange) return {0, fmt::format("has the odd unit `{}`", name)};
  const double value = convert(number, unit.get(), target);
  if (!std::isfinite(value)) return {0, "is too large"};
  return {value, {}};
}

Quantity read(const std::string& text, const ut_unit* target) {
  double number = 0;
  const std::size_t end = read_number(text, number);
  const std::string fault = fault_of_number(text, end);
  if (!fault.empty()) return {0, fault};
  const std::string name = unit_name(text.substr(end));
  if (name.empty()) return {0, "has no unit"};
  if (name == "C") return {0, "is in coulomb: the unit of temperature is degC or K"};
  const bool is_one = name == "1" && ut_compare(target, parse_unit("1").get()) == 0; // a ratio to the last bit
  const std::size_t at = is_one ? std::string::npos : number_in(name);
  if (at == 0 || (at == 1 && name[0] == '.')) return {0, "has a unit that begins with a digit"};
  if (at != std::string::npos || holds_named_number(name)) return {0, "has a number in its unit"};
  return in_unit(number, name, target);
}

// Texts of which one is meant, where number or signs of `text` are odd.
std::vector<std::string> with_plain_number(const std::string& text) {
  const std::string_view marked = marked_number(text);
  if (marked.empty()) return {};
  const auto start = static_cast<std::size_t>(marked.data() - text.data());
  const std::string rest = text.substr(start + marked.size());
  const std::string signs = replaced(text.substr(0, start), {" ", ""});
  std::vector<std::string> numbers = without_marks(marked);
  if (numbers.empty()) numbers.emplace_back(marked);
  std::vector<std::string> result;
  for (const std::string& number : numbers) {
    if (signs != "-") result.push_back(number + rest);
    if (signs == "-" || signs.size() > 1) result.push_back("-" + number + rest);
  }
  return result;
}

// Units that may be meant by `name`, which holds a number at `at` (npos: none).
std::vector<std::string> other_units(const std::string& name, std::size_t at) {
  std::vector<std::string> result = {common_unit(name), replaced(name, {" ", ""})};
  constexpr std::array aliases = {"f",     "degF",   "°",      "degC",    "'",      "ft",  "\"",     "in",
                                  "kg/m2", "kgf/m2", "kg/cm2", "kgf/cm2", "lb/ft2", "psf", "lb/in2", "psi"};
  for (std::size_t i = 0; i < aliases.size(); i += 2) {
    if (folded(name) == aliases[i]) result.emplace_back(aliases[i + 1]);
  }
  if (at == std::string::npos) return result;
  static constexpr const char* joints = " @/*.,^+-(";
  const auto without_joints = [&](std::string_view text) { return text.substr(0, text.find_last_not_of(joints) + 1); };
  std::string_view before = without_joints(std::string_view(name).substr(0, at));
  before.remove_suffix(operation_at_end(before));
  result.emplace_back(without_joints(before));
  return result;
}

// What a sum ("3 m 20 cm", where "3 m 20" lacks the unit) or a calculation ("4 m/2") in the text comes to.
std::optional<double> sum_or_result(const std::string& text, const ut_unit* target) {
  double number = 0;
  const std::size_t end = read_number(text, number);
  const std::string name = unit_name(text.substr(end));
  const std::size_t at = number_in(name);
  if (end == 0 || at == 0 || (at == std::string::npos && !holds_named_number(name))) return std::nullopt;
  const std::string_view before = trimmed(std::string_view(name).substr(0, at));
  if (at == std::string::npos || before.ends_with('/') || before.ends_with('*')) {
    const Quantity result = in_unit(number, replaced(name, {" /", "/", " *", "*", "* ", "*"}), target);
    return result.error.empty() ? std::optional(result.value) : std::nullopt;
  }
  const bool in_centimetres = before == "m" && at + 2 == name.size() && is_digit(name[at + 1]);
  const std::string rest = name.substr(at) + (in_centimetres ? " cm" : "");
  const Quantity first = read(fmt::format("{} {}", text.substr(0, end), before), target);
  const Quantity one = read(fmt::format("1 {}", before), target);
  const Quantity second = read(rest, target);
  const std::optional<double> more = second.error.empty() ? second.value : sum_or_result(rest, target);
  if (!first.error.empty() || !one.error.empty() || !more || *more >= one.value) return std::nullopt;
  return first.value + std::copysign(*more, number);
}

// A value in the unit that is spoken of.
std::string in_use(double value, const std::string& unit) {
  if (unit == "K") return fmt::format("{:.6g} degC", celsius(value));
  if (unit == "rad") return fmt::format("{:.6g} deg", value * 180 / std::numbers::pi);
  if (unit == "1") return fmt::format("{:.6g} %", 100 * value);
  return fmt::format("{:.6g} {}", value, unit);
}

// " or "-joined texts that can be read and of which one is likely meant; empty: no idea.
std::string meant(const std::string& text, const std::string& unit, const ut_unit* target) {
  const auto is_fine = [&](const std::string& guess) { return read(guess, target).error.empty(); };
  const std::vector<std::string> numbers = with_plain_number(text);
  if (!numbers.empty() && std::all_of(numbers.begin(), numbers.end(), is_fine)) {
    return fmt::format("`{}`", fmt::join(numbers, "` or `"));
  }
  double number = 0;
  const std::size_t end = read_number(text, number);
  if (const auto value = sum_or_result(text, target)) return fmt::format("`{}`", in_use(*value, unit));
  const std::string name = unit_name(text.substr(end));
  for (const std::string& other : other_units(name, number_in(name))) {
    const std::string guess = fmt::format("{} {}", text.substr(0, end), other);
    if (is_fine(guess)) return fmt::format("`{}`", guess);
  }
  return {};
}

} // namespace

std::string dimension_of(const std::string& unit) {
  return dimension_in(unit).name;
}

Quantity parse_quantity(std::string_view text, const std::string& unit, const std::string& example) {
  const auto wrong = [&](const std::string& what, const std::string& guess = "") {
    const Dimension dimension = dimension_in(unit);
    const std::string instead = guess.empty() ? fmt::format("expected {} such as `{}`", dimension.name,
                                                            example.empty() ? dimension.example : example)
                                              : fmt::format("did you mean {}?", guess);
    return Quantity{0, fmt::format("{} {}; {}", as_written(text), what, instead)};
  };
  if (text.size() > longest) return wrong(fmt::format("is longer than {} characters", longest));
  const std::string plain = typed(text);
  if (std::any_of(plain.begin(), plain.end(), is_control)) return wrong("holds a control character");
  const Unit target = parse_unit(unit);
  const Quantity result = read(plain, target.get());
  return result.error.empty() ? result : wrong(result.error, meant(plain, unit, target.get()));
}

std::string shown(double value, const std::string& unit) {
  const std::string in_si = fmt::format("{:.6g}{}", value, unit == "1" ? "" : " " + unit);
  const std::string spoken = in_use(value, unit);
  return spoken == in_si ? in_si : fmt::format("{} ({})", in_si, spoken);
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
