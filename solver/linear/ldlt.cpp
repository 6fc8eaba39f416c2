// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/ldlt.h"

#include <mutex>
#include <new>
#include <stdexcept>
#include <string>

#include <dmumps_c.h>

namespace pneuma::solver::linear {

namespace {

// MUMPS' manual counts from one and knows its settings by number
constexpr int ordering = 7, scaling = 8, usual_ordering = 12, workspace_percent = 14, find_null_pivots = 24;
constexpr int info = 1, negative = 12, null = 28;
constexpr int smallest_pivot = 19, largest_pivot = 21;
constexpr int amd = 0, pord = 4, qamd = 6;
constexpr int null_threshold = 3;
constexpr double noise = 1e-13; // of the matrix' norm: a smaller pivot is none
// MUMPS keeps its load balance in variables of the whole process: two instances at once break each other
std::mutex one_at_a_time; // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

enum Job : std::uint8_t { analyse = 1, factorise = 2, solve_for = 3 };

} // namespace

struct Ldlt::Workspace {
  DMUMPS_STRUC_C mumps{};
  std::vector<MUMPS_INT> row, column;

  Workspace() {
    mumps.par = 1;
    mumps.sym = 2;
    mumps.comm_fortran = -987654; // MPI_COMM_WORLD, in MUMPS' own words
    mumps.job = -1;
    const std::scoped_lock lock(one_at_a_time);
    dmumps_c(&mumps);
    for (const int printing : {1, 2, 3}) setting(printing) = -1;
    setting(4) = 0;
    setting(scaling) = 0; // it would blow up rows that are zero but for rounding
    setting(usual_ordering) = 1;
    setting(workspace_percent) = 30;
    setting(find_null_pivots) = 1;
    mumps.cntl[null_threshold - 1] = noise;
  }
  ~Workspace() {
    const std::scoped_lock lock(one_at_a_time);
    mumps.job = -2;
    dmumps_c(&mumps);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  MUMPS_INT& setting(int number) { return mumps.icntl[number - 1]; }
  int told(int number) const { return mumps.infog[number - 1]; }
  double told_real(int number) const { return mumps.rinfog[number - 1]; }

  void run(Job job) {
    const std::scoped_lock lock(one_at_a_time);
    mumps.job = job;
    dmumps_c(&mumps);
    while (job == factorise && (told(info) == -8 || told(info) == -9) && setting(workspace_percent) < 2000) {
      setting(workspace_percent) *= 2; // more pivots were delayed than the analysis made room for
      dmumps_c(&mumps);
    }
    if (told(info) == -13) throw std::bad_alloc();
    if (told(info) < 0) throw std::runtime_error("MUMPS stopped with INFOG(1) = " + std::to_string(told(info)));
  }
};

Ldlt::Ldlt(const SymmetricPattern& pattern) : workspace_(std::make_unique<Workspace>()) {
  Workspace& w = *workspace_;
  w.mumps.n = pattern.size;
  w.mumps.nnz = static_cast<MUMPS_INT8>(pattern.row.size());
  if (pattern.size == 0) return;
  // PORD gives the least fill of those Debian's build has, but ends the process on small graphs, and is ten to twenty
  // times slower than QAMD where dense borders stand around the matrix (40 000 unknowns)
  const bool has_borders = pattern.column_start.end()[-1] - pattern.column_start.end()[-2] > pattern.size / 2;
  w.setting(ordering) = pattern.size < 1000 ? amd : has_borders ? qamd : pord;
  w.row.reserve(pattern.row.size());
  w.column.reserve(pattern.row.size());
  for (Index column = 0; column < pattern.size; ++column) {
    const auto j = static_cast<std::size_t>(column);
    for (Index k = pattern.column_start[j]; k < pattern.column_start[j + 1]; ++k) {
      w.row.push_back(pattern.row[static_cast<std::size_t>(k)] + 1);
      w.column.push_back(column + 1);
    }
  }
  w.mumps.irn = w.row.data();
  w.mumps.jcn = w.column.data();
  w.run(analyse);
}

Ldlt::~Ldlt() = default;
Ldlt::Ldlt(Ldlt&&) noexcept = default;
Ldlt& Ldlt::operator=(Ldlt&&) noexcept = default;

bool Ldlt::factorize(const SymmetricPattern& pattern, std::span<const double> values) {
  if (pattern.size == 0) return true;
  workspace_->mumps.a = const_cast<double*>(values.data()); // read only
  workspace_->run(factorise);
  return null_pivots() == 0;
}

MatX Ldlt::solve(const MatX& b) {
  MatX x = b;
  if (b.size() == 0) return x;
  Workspace& w = *workspace_;
  w.mumps.rhs = x.data();
  w.mumps.nrhs = static_cast<MUMPS_INT>(b.cols());
  w.mumps.lrhs = static_cast<MUMPS_INT>(b.rows());
  w.run(solve_for);
  return x;
}

int Ldlt::negative_pivots() const {
  return workspace_->mumps.n == 0 ? 0 : workspace_->told(negative);
}

int Ldlt::null_pivots() const {
  return workspace_->mumps.n == 0 ? 0 : workspace_->told(null);
}

double Ldlt::pivot_ratio() const {
  if (workspace_->mumps.n == 0) return 1;
  const double largest = workspace_->told_real(largest_pivot);
  return largest > 0 ? workspace_->told_real(smallest_pivot) / largest : 0;
}

} // namespace pneuma::solver::linear
