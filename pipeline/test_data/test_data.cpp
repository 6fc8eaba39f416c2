// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/test_data/test_data.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "pipeline/schema/quantity.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::test_data {

namespace {

using yaml::Mark;
using yaml::Problem;

struct Column {
  const char* name;
  const char* unit; // SI; empty: a plain number
  double Row::*value;
};

constexpr std::array columns = {Column{"strain_1", "1", &Row::strain_1},
                                Column{"strain_2", "1", &Row::strain_2},
                                Column{"stress_1", "Pa", &Row::stress_1},
                                Column{"stress_2", "Pa", &Row::stress_2},
                                Column{"shear_strain", "1", &Row::shear_strain},
                                Column{"shear_stress", "Pa", &Row::shear_stress},
                                Column{"time", "s", &Row::time},
                                Column{"temperature", "K", &Row::temperature},
                                Column{"weight", "", &Row::weight}};

// A strain and the stress that does work on it.
struct Pair {
  const char* strain_name;
  const char* stress_name;
  double Row::*strain;
  double Row::*stress;
};

constexpr std::array pairs = {Pair{"strain_1", "stress_1", &Row::strain_1, &Row::stress_1},
                              Pair{"strain_2", "stress_2", &Row::strain_2, &Row::stress_2},
                              Pair{"shear_strain", "shear_stress", &Row::shear_strain, &Row::shear_stress}};

// The pair of the larger stress that was measured.
const Pair& larger(const Row& row) {
  const Pair* best = pairs.data();
  for (const Pair& pair : pairs) {
    if (!(std::abs(row.*best->stress) >= std::abs(row.*pair.stress)) && !std::isnan(row.*pair.stress)) best = &pair;
  }
  return *best;
}

// Of the difference of stresses on that of strains, in what was measured.
double work(const Row& from, const Row& to) {
  double sum = 0;
  for (const Pair& pair : pairs) {
    const double one = (to.*pair.strain - from.*pair.strain) * (to.*pair.stress - from.*pair.stress);
    if (!std::isnan(one)) sum += one;
  }
  return sum;
}

std::vector<std::string> known_names() {
  std::vector<std::string> names;
  for (const Column& column : columns) names.emplace_back(column.name);
  return names;
}

// A part of a line without the blanks around it, and where it begins (1-based).
struct Cell {
  std::string text;
  int column = 1;
};

std::vector<Cell> cells_of(std::string_view line, char separator) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    std::string_view part = line.substr(begin, end - begin);
    const std::size_t first = std::min(part.find_first_not_of(" \t"), part.size());
    part.remove_prefix(first);
    part = part.substr(0, part.find_last_not_of(" \t") + 1);
    if (part.size() >= 2 && part.front() == '"' && part.back() == '"') part = part.substr(1, part.size() - 2);
    cells.push_back({std::string(part), static_cast<int>(begin + first) + 1});
    if (end == line.size()) return cells;
    begin = end + 1;
  }
}

// What stands between the columns of a header. Blanks may stand around each of them, a tab is one where nothing else
// is.
char separator_of(std::string_view header) {
  for (const char separator : {';', ',', '\t'}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

const char* name_of(char separator) {
  return separator == ';' ? "semicolons" : separator == ',' ? "commas" : "tabs";
}

struct Title {
  const Column* column = nullptr;
  std::string unit;
};

class Reader {
public:
  Reader(std::string name, Measure measure, std::vector<Problem>& problems)
      : name_(std::move(name)), measure_(measure), problems_(problems) {}

  std::vector<Row> read(std::string_view text, const std::vector<std::string>& needed) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3); // byte order mark
    std::vector<Row> rows;
    if (text.find('\0') != std::string_view::npos) {
      fail(1, "the file is no text in UTF-8 (a spreadsheet's own format, or UTF-16); export it as CSV in UTF-8");
      return rows;
    }
    bool has_header = false;
    for (; !text.empty(); ++line_) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (line.ends_with('\r')) line.remove_suffix(1);
      const std::size_t first = line.find_first_not_of(" \t");
      if (first == std::string_view::npos || line[first] == '#') continue;
      if (!has_header) {
        has_header = true;
        if (!read_header(line, needed)) return rows;
      } else if (std::optional<Row> row = read_row(line, rows)) {
        rows.push_back(*row);
      }
    }
    check_plausible(rows);
    const auto is_mine = [this](const Problem& problem) { return problem.mark.file == name_; };
    const auto has_weight = [](const Row& row) { return row.weight > 0; };
    if (!rows.empty() && std::none_of(rows.begin(), rows.end(), has_weight)) {
      fail(1, "no row has a `weight` above 0");
    }
    if (rows.empty() && std::none_of(problems_.begin(), problems_.end(), is_mine)) {
      fail(1, has_header ? "the file has a header and no rows"
                         : "the file is empty; test data begin with a header such as `strain_1 [%], stress_1 [MPa]`");
    }
    return rows;
  }

private:
  void fail(int column, std::string message) {
    problems_.push_back({Mark{name_, line_, column}, std::move(message), true});
  }

  void warn(int line, int column, std::string message) {
    problems_.push_back({Mark{name_, line, column}, std::move(message), false});
  }

  bool read_header(std::string_view line, const std::vector<std::string>& needed) {
    const std::size_t before = problems_.size();
    separator_ = separator_of(line);
    const std::vector<Cell> cells = cells_of(line, separator_);
    if (cells.size() == 1 && !check_single(cells.front())) return false;
    const auto is_number = [](const Cell& cell) { return schema::parse_number(cell.text).has_value(); };
    if (std::all_of(cells.begin(), cells.end(), is_number)) {
      fail(1, "the first line must name the columns with their units, as in `strain_1 [%], stress_1 [MPa]`");
      return false;
    }
    for (const Cell& cell : cells) read_title(cell);
    if (problems_.size() > before) return false; // a column that is missing may have an unknown name
    for (const std::string& name : needed) {
      const bool is_there = std::any_of(titles_.begin(), titles_.end(), [&](const Title& title) {
        return title.column != nullptr && title.column->name == name;
      });
      if (!is_there) fail(1, fmt::format("the column `{}` is missing", name));
    }
    return problems_.size() == before;
  }

  // A header of one title, or of several between which stands nothing that separates.
  bool check_single(const Cell& cell) {
    const std::size_t end = cell.text.find(']');
    const std::size_t next = end == std::string::npos ? end : cell.text.find_first_not_of(" \t", end + 1);
    if (next == std::string::npos) return true;
    const bool is_blank = std::isalpha(static_cast<unsigned char>(cell.text[next])) != 0;
    fail(cell.column + static_cast<int>(end) + 1,
         fmt::format("{} between the columns; write commas, semicolons or tabs",
                     is_blank ? "only blanks stand" : fmt::format("`{}` stands", cell.text[next])));
    return false;
  }

  void read_title(const Cell& cell) {
    const std::size_t bracket = std::min(cell.text.find('['), cell.text.size());
    const std::string name = cell.text.substr(0, cell.text.find_last_not_of(" \t", bracket - 1) + 1);
    const auto column = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
    Title title;
    if (cell.text.empty()) {
      fail(cell.column, "a column without a name; take its separator out of all lines");
    } else if (name.find('(') != std::string::npos) {
      fail(cell.column, fmt::format("`{}`: units stand in square brackets, as in `strain_1 [%]`", name));
    } else if (column == columns.end()) {
      fail(cell.column, fmt::format("unknown column `{}`{}; known: {}", name, schema::suggestion(name, known_names()),
                                    schema::joined(known_names())));
    } else {
      title.column = &*column;
      if (std::any_of(titles_.begin(), titles_.end(), [&](const Title& t) { return t.column == title.column; })) {
        fail(cell.column, fmt::format("a second column `{}`", name));
      }
      read_unit(cell, bracket, title);
    }
    titles_.push_back(title);
  }

  void read_unit(const Cell& cell, std::size_t bracket, Title& title) {
    const std::string wanted = title.column->unit;
    if (bracket == cell.text.size()) {
      if (wanted.empty()) return;
      return fail(cell.column, fmt::format("the column `{}` says no unit; write `{} [{}]`", title.column->name,
                                           title.column->name, wanted == "1" ? "-" : wanted));
    }
    if (!cell.text.ends_with(']')) {
      return fail(cell.column, fmt::format("`{}` lacks the closing bracket of its unit", cell.text));
    }
    title.unit = cell.text.substr(bracket + 1, cell.text.size() - bracket - 2);
    if (title.unit == "-" && (wanted == "1" || wanted.empty())) title.unit = "1";
    if (wanted.empty()) {
      if (title.unit != "1") fail(cell.column, fmt::format("`{}` has no unit", title.column->name));
      return;
    }
    const schema::Quantity one = schema::parse_quantity("1 " + title.unit, wanted);
    if (!one.error.empty()) fail(cell.column, fmt::format("unit of `{}`: {}", title.column->name, one.error));
  }

  std::optional<Row> read_row(std::string_view line, const std::vector<Row>& before) {
    const std::size_t faults = problems_.size();
    const std::vector<Cell> cells = cells_of(line, separator_);
    if (cells.size() != titles_.size()) {
      const char separator = separator_of(line);
      const bool is_decimal = separator == ',' && decimal_mark_ == ',';
      std::string hint;
      if (separator != separator_ && !is_decimal && cells_of(line, separator).size() == titles_.size()) {
        hint = fmt::format(": the header separates by {}, this line by {}", name_of(separator_), name_of(separator));
      } else if (cells.size() > titles_.size() && separator_ == ',') {
        hint = ": where numbers have decimal commas, semicolons or tabs must separate the columns, in the header too";
      } else if (cells.size() == 1 && titles_.size() > 1) {
        hint = fmt::format(": {} must separate them, as in the header", name_of(separator_));
      }
      fail(1, fmt::format("{} cell{} under {} columns{}", cells.size(), cells.size() == 1 ? " stands" : "s stand",
                          titles_.size(), hint));
      return std::nullopt;
    }
    Row row;
    row.line = line_;
    for (std::size_t i = 0; i < cells.size(); ++i) read_cell(cells[i], titles_[i], row);
    if (problems_.size() > faults) return std::nullopt;
    check(row, cells, before);
    return problems_.size() > faults ? std::nullopt : std::optional<Row>(row);
  }

  void read_cell(const Cell& cell, const Title& title, Row& row) {
    const char* name = title.column->name;
    if (cell.text.empty()) {
      return fail(cell.column,
                  fmt::format("a hole: `{}` has no value here; leave the row out, or keep rows without `{}` in a file "
                              "of their own",
                              name, name));
    }
    std::string text = cell.text;
    if (!read_decimal_comma(cell, text)) return;
    const std::optional<double> number = schema::parse_number(text);
    if (!number) return fail(cell.column, fmt::format("`{}` must be a plain number, not `{}`", name, cell.text));
    row.*title.column->value =
        *title.column->unit == '\0'
            ? *number
            : schema::parse_quantity(fmt::format("{} {}", text, title.unit), title.column->unit).value;
  }

  // Puts a point for the decimal comma of a number. Where a file has both, one of them may part thousands.
  bool read_decimal_comma(const Cell& cell, std::string& text) {
    const std::size_t comma = text.find(',');
    const std::size_t point = text.find('.');
    if (comma == std::string::npos && point == std::string::npos) return true;
    const char mark = comma != std::string::npos ? ',' : '.';
    if (decimal_mark_ == '\0') decimal_mark_ = mark;
    if (mark != decimal_mark_ || (comma != std::string::npos && point != std::string::npos)) {
      fail(cell.column, fmt::format("`{}`: decimal commas and points in one file; write one of them, and nothing "
                                    "between thousands",
                                    cell.text));
      return false;
    }
    if (mark == ',') text[comma] = '.'; // a second one makes it no number
    return true;
  }

  void check(const Row& row, const std::vector<Cell>& cells, const std::vector<Row>& before) {
    const double smallest = measure_ == Measure::engineering ? -1 : -0.5;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string name = titles_[i].column->name;
      if (name.starts_with("strain") && !(row.*titles_[i].column->value > smallest)) {
        fail(cells[i].column, fmt::format("`{}` must be above {}, where nothing is left of the length, not {}", name,
                                          smallest, cells[i].text));
      }
      constexpr double most = 5; // 500 %
      if (name.find("strain") != std::string::npos && titles_[i].unit == "1" &&
          std::abs(row.*titles_[i].column->value) > most && told_.insert(name).second) {
        warn(line_, cells[i].column,
             fmt::format("`{0}` of {1} [-] is {2:.4g} %; is the unit `{0} [%]` meant?", name, cells[i].text,
                         100 * row.*titles_[i].column->value));
      }
      constexpr double coldest = 150, hottest = 500; // K
      if (name == "temperature" && !(row.temperature >= coldest && row.temperature <= hottest) &&
          told_.insert(name).second) {
        warn(line_, cells[i].column,
             fmt::format("`temperature` of {} [{}] is {:.4g} K; is the unit right?", cells[i].text, titles_[i].unit,
                         row.temperature));
      }
      if (name == "weight" && row.weight < 0) {
        fail(cells[i].column, fmt::format("`weight` must be at least 0, not {}", cells[i].text));
      }
      if (name == "time" && !before.empty() && row.time < before.back().time) {
        fail(cells[i].column, fmt::format("the time runs backwards: {} s after {} s", row.time, before.back().time));
      }
    }
  }

  void check_plausible(const std::vector<Row>& rows) {
    if (rows.empty()) return;
    check_modulus(rows);
    for (const Pair& pair : pairs) check_rise(rows, pair);
    if (std::isnan(rows.front().time)) check_repeated(rows);
  }

  // The secant where the stress first is a quarter of the largest one, past the slack of the grips.
  void check_modulus(const std::vector<Row>& rows) {
    constexpr double least = 1e6, most = 100e9; // Pa, of foils
    double largest = 0;
    for (const Row& row : rows) largest = std::max(largest, std::abs(row.*larger(row).stress));
    for (const Row& row : rows) {
      const Pair& pair = larger(row);
      const double stress = std::abs(row.*pair.stress), strain = std::abs(row.*pair.strain);
      if (!(stress > 0 && stress >= largest / 4 && strain > 0)) continue;
      const double modulus = stress / strain;
      if (modulus >= least && modulus <= most) return;
      warn(row.line, 1,
           fmt::format("{:.4g} MPa at a strain of {:.4g} % mean a modulus of {:.3g} MPa, where foils have 1 MPa to 100 "
                       "GPa; are the units of `{}` and `{}` right?",
                       stress / 1e6, 100 * strain, modulus / 1e6, pair.stress_name, pair.strain_name));
      return;
    }
  }

  // Less stress at more strain, past noise, where the piece gives work back (Drucker): grips that slip, a tear. Not the
  // way from one path of a table of strains to the next.
  void check_rise(const std::vector<Row>& rows, const Pair& pair) {
    constexpr double noise_of_strain = 0.01, noise_of_stress = 0.02; // of the largest
    double strain = 0, stress = 0;
    for (const Row& row : rows) {
      strain = std::max(strain, std::abs(row.*pair.strain));
      stress = std::max(stress, std::abs(row.*pair.stress));
    }
    strain *= noise_of_strain;
    stress *= noise_of_stress;
    const Row* front = rows.data(); // of the largest strain since it fell last
    const Row* peak = front;        // of the largest stress since then
    for (const Row& row : rows) {
      if (row.*pair.strain < front->*pair.strain - strain) {
        front = peak = &row;
        continue;
      }
      if (row.*pair.strain > front->*pair.strain) front = &row;
      if (row.*pair.stress > peak->*pair.stress) peak = &row;
      if (!(row.*pair.strain - peak->*pair.strain > strain && peak->*pair.stress - row.*pair.stress > stress)) continue;
      if (work(*peak, row) >= 0) continue;
      return warn(row.line, 1,
                  fmt::format("`{}` falls from {:.4g} MPa (line {}) to {:.4g} MPa while `{}` rises from {:.4g} % to "
                              "{:.4g} %: do the grips slip, or is the foil torn?",
                              pair.stress_name, peak->*pair.stress / 1e6, peak->line, row.*pair.stress / 1e6,
                              pair.strain_name, 100 * peak->*pair.strain, 100 * row.*pair.strain));
    }
  }

  void check_repeated(const std::vector<Row>& rows) {
    constexpr double noise = 0.02; // of the largest stress
    for (std::size_t i = 1; i < rows.size(); ++i) {
      bool same = true, other = false;
      for (const Pair& pair : pairs) {
        if (std::isnan(rows[i].*pair.strain)) continue;
        double largest = 0;
        for (const Row& row : rows) largest = std::max(largest, std::abs(row.*pair.stress));
        same = same && rows[i].*pair.strain == rows[i - 1].*pair.strain;
        other = other || std::abs(rows[i].*pair.stress - rows[i - 1].*pair.stress) > noise * largest;
      }
      if (!same || !other) continue;
      return warn(rows[i].line, 1,
                  fmt::format("the strains of line {} again, with other stresses; without a column `time` one of them "
                              "is too many",
                              rows[i - 1].line));
    }
  }

  std::string name_;
  Measure measure_;
  std::vector<Problem>& problems_;
  std::vector<Title> titles_;
  std::set<std::string> told_; // columns
  char separator_ = ',';
  char decimal_mark_ = '\0'; // of the first number that has one
  int line_ = 1;
};

// Strain and stress of one direction.
void convert(double& strain, double& stress, Measure to) {
  if (to == Measure::green_lagrange) {
    stress /= 1 + strain;
    strain *= 1 + 0.5 * strain;
  } else {
    const double stretch = std::sqrt(1 + 2 * strain);
    stress *= stretch;
    strain = 2 * strain / (1 + stretch);
  }
}

} // namespace

std::vector<Row> parse(const std::string& text, const std::string& name, Measure measure,
                       const std::vector<std::string>& needed, std::vector<Problem>& problems) {
  return Reader(name, measure, problems).read(text, needed);
}

Row converted(const Row& row, Measure from, Measure to) {
  Row out = row;
  if (from == to) return out;
  convert(out.strain_1, out.stress_1, to);
  convert(out.strain_2, out.stress_2, to);
  return out;
}

Tests read_tests(const std::vector<std::string>& files, const yaml::Mark& named, Measure measure,
                 const std::vector<std::string>& needed, std::vector<Problem>& problems) {
  Tests tests;
  for (const std::string& text : files) {
    const auto file = (std::filesystem::path(named.file).parent_path() / text).lexically_normal();
    const std::size_t before = problems.size();
    const std::string content = yaml::read_text(file, named, problems);
    if (problems.size() > before) continue;
    for (const Row& row : parse(content, file.generic_string(), measure, needed, problems)) {
      tests.rows.push_back(converted(row, measure, Measure::green_lagrange));
      tests.marks.push_back({file.generic_string(), row.line, 1});
      if (std::isnan(row.temperature)) continue;
      const auto [least, most] = tests.temperatures.value_or(std::array{row.temperature, row.temperature});
      tests.temperatures = {std::min(least, row.temperature), std::max(most, row.temperature)};
    }
  }
  return tests;
}

} // namespace pneuma::pipeline::test_data
