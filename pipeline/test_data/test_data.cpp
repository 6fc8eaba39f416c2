// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/test_data/test_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "pipeline/schema/quantity.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::test_data {

namespace {

using schema::Mark;
using schema::Problem;

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

std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view part = line.substr(begin, end - begin);
    const std::size_t first = std::min(part.find_first_not_of(" \t"), part.size());
    part.remove_prefix(first);
    part = part.substr(0, part.find_last_not_of(" \t") + 1);
    cells.push_back({std::string(part), static_cast<int>(begin + first) + 1});
    if (end == line.size()) return cells;
    begin = end + 1;
  }
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
    const auto is_mine = [this](const Problem& problem) { return problem.mark.file == name_; };
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

  bool read_header(std::string_view line, const std::vector<std::string>& needed) {
    const std::size_t before = problems_.size();
    for (const Cell& cell : cells_of(line)) read_title(cell);
    for (const std::string& name : needed) {
      const bool is_there = std::any_of(titles_.begin(), titles_.end(), [&](const Title& title) {
        return title.column != nullptr && title.column->name == name;
      });
      if (!is_there) fail(1, fmt::format("the column `{}` is missing", name));
    }
    return problems_.size() == before;
  }

  void read_title(const Cell& cell) {
    const std::size_t bracket = std::min(cell.text.find('['), cell.text.size());
    const std::string name = cell.text.substr(0, cell.text.find_last_not_of(" \t", bracket - 1) + 1);
    const auto column = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
    Title title;
    if (column == columns.end()) {
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
    const std::vector<Cell> cells = cells_of(line);
    if (cells.size() != titles_.size()) {
      fail(1, fmt::format("{} cells stand under {} columns", cells.size(), titles_.size()));
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
    const std::optional<double> number = schema::parse_number(cell.text);
    if (!number) return fail(cell.column, fmt::format("`{}` must be a plain number, not `{}`", name, cell.text));
    row.*title.column->value =
        *title.column->unit == '\0'
            ? *number
            : schema::parse_quantity(fmt::format("{} {}", cell.text, title.unit), title.column->unit).value;
  }

  void check(const Row& row, const std::vector<Cell>& cells, const std::vector<Row>& before) {
    const double smallest = measure_ == Measure::engineering ? -1 : -0.5;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string name = titles_[i].column->name;
      if (name.starts_with("strain") && !(row.*titles_[i].column->value > smallest)) {
        fail(cells[i].column, fmt::format("`{}` must be above {}, where nothing is left of the length, not {}", name,
                                          smallest, cells[i].text));
      }
      if (name == "weight" && row.weight < 0) {
        fail(cells[i].column, fmt::format("`weight` must be at least 0, not {}", cells[i].text));
      }
      if (name == "time" && !before.empty() && row.time < before.back().time) {
        fail(cells[i].column, fmt::format("the time runs backwards: {} s after {} s", row.time, before.back().time));
      }
    }
  }

  std::string name_;
  Measure measure_;
  std::vector<Problem>& problems_;
  std::vector<Title> titles_;
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

} // namespace pneuma::pipeline::test_data
