// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::solver::linear {

using base::Index;
using base::MatX;
using base::VecX;

// Where a sparse symmetric matrix has entries: its upper triangle by columns, rows sorted. Fixed once; values change.
struct SymmetricPattern {
  Index size = 0;
  std::vector<Index> column_start; // [size + 1]
  std::vector<Index> row;
};

// Where each element's matrix goes: for its entries (i <= j), column by column, the position in the values, or -1 where
// an unknown is held.
struct Scatter {
  Index per_element = 0;       // unknowns of an element, m
  std::vector<Index> position; // [element][m (m+1) / 2]
};

struct PatternAndScatter {
  SymmetricPattern pattern;
  Scatter scatter;
};

// From the unknowns of every element, [element][per_element], -1 where held.
PatternAndScatter make_pattern(Index size, std::span<const Index> element_unknowns, Index per_element);

// values += element matrix (symmetric, per_element x per_element, column major), fixed order: same bits every time.
// Only the upper triangle of `matrix` is read.
inline void scatter_add(const Scatter& scatter, Index element, const double* matrix, std::span<double> values) {
  const auto m = static_cast<std::size_t>(scatter.per_element);
  const Index* position = scatter.position.data() + static_cast<std::size_t>(element) * (m * (m + 1) / 2);
  for (std::size_t j = 0; j < m; ++j) {
    for (std::size_t i = 0; i <= j; ++i, ++position) {
      if (*position >= 0) values[static_cast<std::size_t>(*position)] += matrix[j * m + i];
    }
  }
}

// y = A x for the symmetric matrix.
VecX multiply(const SymmetricPattern& pattern, std::span<const double> values, const VecX& x);

} // namespace pneuma::solver::linear
