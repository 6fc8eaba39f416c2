// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/control.h"

#include <cmath>

namespace pneuma::solver::path {

namespace {

double free_nodes(const System& system) {
  return std::max(1.0, static_cast<double>(system.unknowns()) / 3);
}

Change zero_form(const System& system) {
  Change form;
  for (const assembly::FoilEquations& foil : system.foils()) form.u.emplace_back(VecX::Zero(foil.pattern.size));
  form.p = VecX::Zero(static_cast<Eigen::Index>(system.model().chambers.size()));
  return form;
}

bool is_unknown(const System& system, Index air) {
  const chamber::Gas& gas = system.model().chambers[static_cast<std::size_t>(air)].gas;
  return !std::holds_alternative<chamber::Regulated>(gas);
}

} // namespace

HeldDisplacement displacement_of(Index node, const Vec3& direction) {
  HeldDisplacement held;
  for (Index c = 0; c < 3; ++c) {
    if (direction[c] != 0) held.weights.emplace_back(3 * node + c, direction[c]);
  }
  return held;
}

double value_of(const Held& held, const System& system, const Configuration& configuration) {
  struct Visitor {
    const System& system;
    const Configuration& at;
    double operator()(const HeldLoadFactor&) const { return at.load_factor; }
    double operator()(const HeldPressure& h) const { return at.pressures[h.chamber]; }
    double operator()(const HeldVolume& h) const { return system.chamber_volume(h.chamber); }
    double operator()(const HeldDisplacement& h) const {
      double sum = 0;
      for (const auto& [k, weight] : h.weights) {
        const auto node = static_cast<std::size_t>(k / 3);
        sum += weight * (at.positions[node][k % 3] - system.model().mesh.nodes[node][k % 3]);
      }
      return sum;
    }
    double operator()(const HeldArc& h) const {
      double sum = 0;
      for (const assembly::FoilEquations& foil : system.foils()) {
        for (const Index k : foil.coordinate) {
          const auto node = static_cast<std::size_t>(k / 3);
          const double change = at.positions[node][k % 3] - h.from[node][k % 3];
          sum += change * change;
        }
      }
      return std::sqrt(sum / free_nodes(system));
    }
  };
  return std::visit(Visitor{system, configuration}, held);
}

Row row_of(const Held& held, double wanted, const System& system, const Configuration& configuration) {
  struct Visitor {
    const System& system;
    const Configuration& at;
    double value;
    Change form;

    void operator()(const HeldLoadFactor&) { form.load_factor = 1; }
    void operator()(const HeldPressure& h) {
      const Index air = system.air_of(h.chamber);
      if (is_unknown(system, air)) {
        form.p[air] = 1;
      } else {
        form.load_factor = chamber::prescribed_rate(system.model().chambers[static_cast<std::size_t>(air)].gas);
      }
    }
    void operator()(const HeldVolume& h) {
      const assembly::Chamber& chamber = system.model().chambers[static_cast<std::size_t>(h.chamber)];
      for (std::size_t i = 0; i < form.u.size(); ++i) {
        const assembly::FoilEquations& foil = system.foils()[i];
        if (foil.block == chamber.outer) form.u[i] += foil.pressure_gradient;
        if (foil.block == chamber.inner) form.u[i] -= foil.pressure_gradient;
      }
      form.load_factor = system.chamber_volume_rate(h.chamber);
    }
    void operator()(const HeldDisplacement& h) {
      for (std::size_t i = 0; i < form.u.size(); ++i) {
        const std::vector<Index>& coordinate = system.foils()[i].coordinate;
        for (std::size_t u = 0; u < coordinate.size(); ++u) {
          for (const auto& [k, weight] : h.weights) {
            if (k == coordinate[u]) form.u[i][static_cast<Eigen::Index>(u)] += weight;
          }
        }
      }
      const VecX& move = system.model().move;
      for (const auto& [k, weight] : h.weights) form.load_factor += move.size() > 0 ? weight * move[k] : 0.0;
    }
    void operator()(const HeldArc& h) {
      const double factor = 1 / (free_nodes(system) * value);
      for (std::size_t i = 0; i < form.u.size(); ++i) {
        const std::vector<Index>& coordinate = system.foils()[i].coordinate;
        for (std::size_t u = 0; u < coordinate.size(); ++u) {
          const Index k = coordinate[u];
          const auto node = static_cast<std::size_t>(k / 3);
          form.u[i][static_cast<Eigen::Index>(u)] = factor * (at.positions[node][k % 3] - h.from[node][k % 3]);
        }
      }
    }
  };
  const double value = value_of(held, system, configuration);
  Visitor visitor{system, configuration, value, zero_form(system)};
  std::visit(visitor, held);
  return {std::move(visitor.form), value - wanted};
}

Farthest farthest(const System& system, Index block, const Configuration& configuration, const Change* change) {
  const geometry::Mesh& mesh = system.model().mesh;
  const Configuration to = change != nullptr ? moved(system, configuration, *change) : configuration;
  Farthest result;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    if (block >= 0 && static_cast<Index>(b) != block) continue;
    for (const Index node : mesh.blocks[b].connectivity) {
      const auto i = static_cast<std::size_t>(node);
      const Vec3 move = to.positions[i] - mesh.nodes[i];
      // the first of equals, so that symmetric meshes choose the same node every time
      if (result.node < 0 || move.squaredNorm() > (1 + 1e-9) * result.move.squaredNorm()) result = {node, move};
    }
  }
  return result;
}

HeldDisplacement displacement_of(const Farthest& farthest) {
  return displacement_of(farthest.node, farthest.move.norm() > 0 ? farthest.move.normalized() : Vec3(0, 0, 1));
}

double span_of(const Configuration& configuration) {
  double span = 0;
  for (const Vec3& x : configuration.positions) span = std::max(span, (x - configuration.positions.front()).norm());
  return span;
}

double root_mean_square(const System& system, const Change& change) {
  return std::sqrt(dot_u(change, change) / free_nodes(system));
}

} // namespace pneuma::solver::path
