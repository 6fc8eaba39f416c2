// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/verification/examples/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace pneuma::tests {

namespace {

std::vector<Row>& rows() {
  static std::vector<Row> all;
  return all;
}

// What was published of it before the thesis: its numbers are in figures.
std::string literature(const Row& row) {
  if (row.thesis.empty()) return "";
  if (row.example == "B1") return "Simo and Taylor 1986: figure only";
  if (row.example == "B4") return "Gruttmann and Taylor 1992: figure only";
  if (row.example == "B9" || row.example == "B10") return "Galliot and Luchsinger 2011: figure only";
  if (row.example == "B11") return "Schiemann 2007: figure only";
  return "";
}

std::string iterations_of(const Row& row) {
  return row.iterations > 0 ? std::to_string(row.iterations) : "";
}

std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

void write_csv(const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "example,quantity,thesis,literature,reference,reference value,ours,error,tolerance,"
          "reason of the tolerance,mesh,iterations,remark\n";
  for (const Row& r : rows()) {
    file << fmt::format("{},{},{},{},{},{:.8g},{:.8g},{:.2e},{:.1e},{},{},{},{}\n", r.example, quoted(r.quantity),
                        quoted(r.thesis), quoted(literature(r)), quoted(r.reference_name), r.reference, r.ours,
                        r.error(), r.tolerance, quoted(r.why), quoted(r.mesh), iterations_of(r), quoted(r.remark));
  }
}

// "1.0e-02: why", or why there is none
std::string tolerance_of(const Row& r) {
  return r.tolerance == unbounded ? r.why : fmt::format("{:.1e}: {}", r.tolerance, r.why);
}

void write_markdown(const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "| | quantity | thesis | literature | reference | | ours | error | tolerance | mesh | iterations | remark |\n"
          "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& r : rows()) {
    file << fmt::format("| {} | {} | {} | {} | {} | {:.6g} | {:.6g} | {:.1e} | {} | {} | {} | {} |\n", r.example,
                        r.quantity, r.thesis, literature(r), r.reference_name, r.reference, r.ours, r.error(),
                        tolerance_of(r), r.mesh, iterations_of(r), r.remark);
  }
}

class Table : public testing::Environment {
public:
  void TearDown() override {
    const char* wanted = std::getenv("PNEUMA_TABLES");
    if (wanted == nullptr || rows().empty()) return;
    // B2 before B10, whichever order the files of the program were linked in
    const auto number = [](const Row& r) { return std::stoi(r.example.substr(1)); };
    std::stable_sort(rows().begin(), rows().end(), [&](const Row& a, const Row& b) { return number(a) < number(b); });
    const std::filesystem::path folder = wanted;
    std::filesystem::create_directories(folder);
    write_csv(folder / "material_examples.csv");
    write_markdown(folder / "material_examples.md");
  }
};

const testing::Environment* const table = testing::AddGlobalTestEnvironment(new Table);

} // namespace

double Row::error() const {
  return std::abs(reference == 0 ? ours : ours / reference - 1);
}

double observed_order(const std::array<double, 3>& n, const std::array<double, 3>& values) {
  const double quotient = (values[0] - values[1]) / (values[1] - values[2]);
  double low = 0, high = 12;
  for (int i = 0; i < 60; ++i) {
    const double p = 0.5 * (low + high);
    const double of_p =
        (std::pow(n[0], -p) - std::pow(n[1], -p)) / (std::pow(n[1], -p) - std::pow(n[2], -p)); // grows with p
    (of_p < quotient ? low : high) = p;
  }
  return low;
}

void expect(const Row& row) {
  EXPECT_LE(row.error(), row.tolerance) << row.example << ", " << row.quantity << ": " << row.ours << " instead of "
                                        << row.reference << " (" << row.reference_name << ")";
  std::printf("%-4s %-50s thesis %-14s %s %.8g, ours %.8g, error %.2e (allowed %.1e), %d iterations\n",
              row.example.c_str(), row.quantity.c_str(), row.thesis.c_str(), row.reference_name.c_str(), row.reference,
              row.ours, row.error(), row.tolerance, row.iterations);
  rows().push_back(row);
}

} // namespace pneuma::tests
