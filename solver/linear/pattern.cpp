// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/pattern.h"

#include <algorithm>

namespace pneuma::solver::linear {

PatternAndScatter make_pattern(Index size, std::span<const Index> element_unknowns, Index per_element) {
  const auto m = static_cast<std::size_t>(per_element);
  const std::size_t elements = m == 0 ? 0 : element_unknowns.size() / m;

  // elements around each unknown, as one array with offsets
  std::vector<std::size_t> start(static_cast<std::size_t>(size) + 1, 0);
  for (const Index u : element_unknowns) {
    if (u >= 0) ++start[static_cast<std::size_t>(u) + 1];
  }
  for (std::size_t u = 0; u < static_cast<std::size_t>(size); ++u) start[u + 1] += start[u];
  std::vector<std::size_t> around(start.back());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < element_unknowns.size(); ++k) {
    if (element_unknowns[k] >= 0) around[next[static_cast<std::size_t>(element_unknowns[k])]++] = k / m;
  }

  PatternAndScatter result;
  SymmetricPattern& pattern = result.pattern;
  pattern.size = size;
  pattern.column_start.reserve(static_cast<std::size_t>(size) + 1);
  pattern.column_start.push_back(0);
  std::vector<Index> rows;
  for (std::size_t column = 0; column < static_cast<std::size_t>(size); ++column) {
    rows.clear();
    rows.push_back(static_cast<Index>(column));
    for (std::size_t k = start[column]; k < start[column + 1]; ++k) {
      for (const Index u : element_unknowns.subspan(around[k] * m, m)) {
        if (u >= 0 && u < static_cast<Index>(column)) rows.push_back(u);
      }
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    pattern.row.insert(pattern.row.end(), rows.begin(), rows.end());
    pattern.column_start.push_back(static_cast<Index>(pattern.row.size()));
  }

  result.scatter.per_element = per_element;
  result.scatter.position.reserve(elements * m * (m + 1) / 2);
  for (std::size_t e = 0; e < elements; ++e) {
    const Index* u = element_unknowns.data() + e * m;
    for (std::size_t j = 0; j < m; ++j) {
      for (std::size_t i = 0; i <= j; ++i) {
        if (u[i] < 0 || u[j] < 0) {
          result.scatter.position.push_back(-1);
          continue;
        }
        const auto column = static_cast<std::size_t>(std::max(u[i], u[j]));
        const auto begin = pattern.row.begin() + pattern.column_start[column];
        const auto end = pattern.row.begin() + pattern.column_start[column + 1];
        const auto found = std::lower_bound(begin, end, std::min(u[i], u[j]));
        result.scatter.position.push_back(static_cast<Index>(found - pattern.row.begin()));
      }
    }
  }
  return result;
}

VecX multiply(const SymmetricPattern& pattern, std::span<const double> values, const VecX& x) {
  VecX y = VecX::Zero(pattern.size);
  for (Index column = 0; column < pattern.size; ++column) {
    const auto j = static_cast<std::size_t>(column);
    for (auto k = static_cast<std::size_t>(pattern.column_start[j]);
         k < static_cast<std::size_t>(pattern.column_start[j + 1]); ++k) {
      const Index row = pattern.row[k];
      y[row] += values[k] * x[column];
      if (row != column) y[column] += values[k] * x[row];
    }
  }
  return y;
}

} // namespace pneuma::solver::linear
