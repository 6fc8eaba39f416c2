// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholesky.h"

#include <new>
#include <stdexcept>

#include <cholmod.h>

namespace pneuma::solver::linear {

struct Cholesky::Workspace {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  cholmod_dense* x = nullptr; // kept between solves
  cholmod_dense* y = nullptr;
  cholmod_dense* e = nullptr;

  Workspace() {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
    common.postorder = 1;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = 1;
  }
  ~Workspace() {
    cholmod_free_dense(&x, &common);
    cholmod_free_dense(&y, &common);
    cholmod_free_dense(&e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  void check(const char* what) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common.status < 0) {
      throw std::runtime_error(std::string(what) + ": CHOLMOD status " + std::to_string(common.status));
    }
  }
};

namespace {

// CHOLMOD's view of our arrays; nothing is copied, nothing written
cholmod_sparse view(const SymmetricPattern& pattern, const double* values) {
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = static_cast<std::size_t>(pattern.size);
  matrix.nzmax = pattern.row.size();
  matrix.p = const_cast<Index*>(pattern.column_start.data());
  matrix.i = const_cast<Index*>(pattern.row.data());
  matrix.x = const_cast<double*>(values);
  matrix.stype = 1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = values != nullptr ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = 1;
  matrix.packed = 1;
  return matrix;
}

} // namespace

Cholesky::Cholesky(const SymmetricPattern& pattern) : workspace_(std::make_unique<Workspace>()) {
  workspace_->common.method[0].ordering = pattern.size < 60000 ? CHOLMOD_AMD : CHOLMOD_METIS;
  cholmod_sparse matrix = view(pattern, nullptr);
  workspace_->factor = cholmod_analyze(&matrix, &workspace_->common);
  workspace_->check("analysis of the tangent");
}

Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

bool Cholesky::factorize(const SymmetricPattern& pattern, std::span<const double> values) {
  if (pattern.size == 0) return true;
  cholmod_sparse matrix = view(pattern, values.data());
  cholmod_factorize(&matrix, workspace_->factor, &workspace_->common);
  workspace_->check("factorisation of the tangent");
  return workspace_->common.status == CHOLMOD_OK;
}

MatX Cholesky::solve(const MatX& b) {
  if (b.size() == 0) return b;
  cholmod_dense right{};
  right.nrow = static_cast<std::size_t>(b.rows());
  right.ncol = static_cast<std::size_t>(b.cols());
  right.nzmax = right.nrow * right.ncol;
  right.d = right.nrow;
  right.x = const_cast<double*>(b.data());
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  Workspace& w = *workspace_;
  cholmod_solve2(CHOLMOD_A, w.factor, &right, nullptr, &w.x, nullptr, &w.y, &w.e, &w.common);
  w.check("solution with the factor");
  return Eigen::Map<const MatX>(static_cast<const double*>(w.x->x), b.rows(), b.cols());
}

double Cholesky::pivot_ratio() const {
  return workspace_->factor->n == 0 ? 1.0 : cholmod_rcond(workspace_->factor, &workspace_->common);
}

} // namespace pneuma::solver::linear
