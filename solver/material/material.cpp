// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/material.h"

namespace pneuma::solver::material {

std::span<const std::string_view> history_names(const Law& law) {
  return std::visit([]<Material M>(const M&) { return std::span<const std::string_view>(M::history_names); }, law);
}

int history_components(const Law& law) {
  return static_cast<int>(history_names(law).size());
}

Relaxed relaxed(const Law& law, const Vec3& strain, const double* history) {
  return std::visit(
      [&]<Material M>(const M& m) -> Relaxed {
        if constexpr (requires { m.relaxed(strain, history); }) {
          return m.relaxed(strain, history);
        } else {
          return {Surface::taut, strain};
        }
      },
      law);
}

bool has_tension_field(const Law& law) {
  return std::visit(
      []<Material M>(const M& m) {
        return requires {
          m.relaxed(Vec3(), nullptr);
        };
      },
      law);
}

bool has_potential(const Law& law) {
  return std::visit(
      []<Material M>(const M& m) {
        const auto fitted_apart = [](const auto& table) {
          if constexpr (requires { table.stress; }) {
            return table.stress.has_value();
          } else {
            return table.first.has_value();
          }
        };
        if constexpr (requires { *m.table; }) {
          return !fitted_apart(*m.table);
        } else if constexpr (requires { *m.law.table; }) {
          return !fitted_apart(*m.law.table);
        } else {
          return true;
        }
      },
      law);
}

bool is_rate_dependent(const Law& law) {
  return std::visit([]<Material M>(const M& m) { return flows_with_time(m); }, law);
}

double thickness_stretch(const Law& law, const Vec3& strain, const double* history) {
  return std::visit([&]<Material M>(const M& m) { return m.thickness_stretch(strain, history); }, law);
}

bool outside_data(const Law& law, const Vec3& strain, const double* history) {
  return std::visit(
      [&]<Material M>(const M& m) {
        if constexpr (requires { m.outside(strain); }) {
          return m.outside(strain);
        } else if constexpr (requires { m.law.outside(strain); }) {
          return m.law.outside(m.relaxed(strain, history).strain);
        } else {
          return false;
        }
      },
      law);
}

std::optional<StrainRange> data_range(const Law& law) {
  return std::visit(
      []<Material M>(const M& m) -> std::optional<StrainRange> {
        if constexpr (requires { m.table->domain; }) {
          return m.table->domain.range;
        } else if constexpr (requires { m.law.table->domain; }) {
          return m.law.table->domain.range;
        } else {
          return std::nullopt;
        }
      },
      law);
}

int evaluate(const Law& law, Batch& batch) {
  return std::visit(
      [&batch]<Material M>(const M& m) {
        for (int i = 0; i < batch.count; ++i) {
          const auto k = static_cast<std::size_t>(i);
          const double* old_history = batch.old_history + i * history_size<M>;
          double* new_history = batch.new_history + i * history_size<M>;
          batch.status = m.evaluate(batch.strain[k], old_history, new_history, batch.dt, batch.response[k]);
          if (batch.status != Status::ok) return i;
        }
        return -1;
      },
      law);
}

} // namespace pneuma::solver::material
