// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/assembly/system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/parallel.h"
#include "geometry/base/place.h"
#include "geometry/volume.h"
#include "solver/element/film.h"

namespace pneuma::solver::assembly {

namespace {

// The symmetric part is what the tangent takes of a load stiffness (numerics 2), and of a law without a potential.
template <int Size>
void symmetrize(Eigen::Matrix<double, Size, Size>& matrix) {
  matrix = (0.5 * (matrix + matrix.transpose())).eval();
}

} // namespace

System::System(Model model, int threads) : model_(std::move(model)), threads_(threads) {
  const geometry::Mesh& mesh = model_.mesh;
  origin_ = Vec3::Zero();
  for (const Vec3& x : mesh.nodes) origin_ += x / static_cast<double>(mesh.nodes.size());
  origin_ = model_.origin.value_or(origin_);

  foil_of_block_.assign(mesh.blocks.size(), -1);
  base_volume_.assign(mesh.blocks.size(), 0.0);
  std::vector<Index> owner(mesh.nodes.size() * 3, -1);
  const auto n = static_cast<std::size_t>(geometry::nodes_per_element(mesh.element));
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const geometry::Block& block = mesh.blocks[b];
    if (!model_.foils[b]) {
      base_volume_[b] = geometry::volume_below(mesh, block, mesh.nodes, origin_);
      continue;
    }
    foil_of_block_[b] = static_cast<Index>(foils_.size());
    FoilEquations foil;
    foil.block = static_cast<Index>(b);
    const Foil& data = *model_.foils[b];
    foil.membrane = {block.connectivity, data.reference, data.law, data.thickness};

    std::vector<Index> unknown(mesh.nodes.size() * 3, -1);
    std::vector<Index> element_unknowns;
    element_unknowns.reserve(block.connectivity.size() * 3);
    for (const Index node : block.connectivity) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t coordinate = 3 * static_cast<std::size_t>(node) + c;
        if (model_.fixed[coordinate] == 0 && unknown[coordinate] < 0) {
          if (owner[coordinate] >= 0) {
            const Vec3& x = mesh.nodes[static_cast<std::size_t>(node)];
            throw base::InputError(
                fmt::format("two foils share a free node at {} m: every edge must be clamped", base::place_text(x)));
          }
          owner[coordinate] = static_cast<Index>(b);
          unknown[coordinate] = static_cast<Index>(foil.coordinate.size());
          foil.coordinate.push_back(static_cast<Index>(coordinate));
        }
        element_unknowns.push_back(unknown[coordinate]);
      }
    }
    linear::PatternAndScatter made =
        linear::make_pattern(static_cast<Index>(foil.coordinate.size()), element_unknowns, static_cast<Index>(3 * n));
    foil.pattern = std::move(made.pattern);
    foil.scatter = std::move(made.scatter);

    foil.laplacian.assign(foil.pattern.row.size(), 0.0);
    const element::Film film{mesh.element, data.reference.rule, block.connectivity, 1.0};
    double area = 0;
    const Index degenerate = element::film_forces(film, mesh.nodes, 0.0, area, [&](const element::ElementBatch& batch) {
      linear::scatter_add(foil.scatter, batch.first, batch.tangent, foil.laplacian);
    });
    if (degenerate >= 0) {
      throw base::GeometryError(fmt::format("element {} of foil `{}` has no area", degenerate, block.name));
    }
    foils_.push_back(std::move(foil));

    const auto history = static_cast<std::size_t>(material::history_components(data.law)) * data.reference.area.size();
    if (!data.history.empty() && data.history.size() != history) {
      throw std::invalid_argument(fmt::format("foil `{}`: a history of {} numbers where its material has {}",
                                              block.name, data.history.size(), history));
    }
    accepted_.push_back(data.history.empty() ? std::vector<double>(history, 0.0) : data.history);
  }
  before_ = new_ = accepted_;
  failed_.resize(foils_.size());
  if (model_.face_pressure.empty()) model_.face_pressure.assign(mesh.blocks.size(), Ramp{});
  const auto coordinates = static_cast<Eigen::Index>(3 * mesh.nodes.size());
  if (model_.dead_from.size() == 0) model_.dead_from = VecX::Zero(coordinates);
  if (model_.dead_to.size() == 0) model_.dead_to = VecX::Zero(coordinates);
  std::vector<std::uint8_t> in_base(model_.fixed.size(), 0);
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    if (model_.foils[b]) continue;
    for (const Index node : mesh.blocks[b].connectivity) {
      for (std::size_t c = 0; c < 3; ++c) in_base[3 * static_cast<std::size_t>(node) + c] = 1;
    }
  }
  for (Eigen::Index k = 0; k < model_.move.size(); ++k) {
    if (model_.move[k] == 0) continue;
    if (model_.fixed[static_cast<std::size_t>(k)] == 0 || in_base[static_cast<std::size_t>(k)] != 0) {
      const Vec3& x = mesh.nodes[static_cast<std::size_t>(k / 3)];
      throw base::InputError(
          fmt::format("the node at {} m cannot be moved: only held nodes of foils are", base::place_text(x)));
    }
    moving_.push_back(static_cast<Index>(k));
  }
}

Index System::unknowns() const {
  Index count = 0;
  for (const FoilEquations& foil : foils_) count += foil.pattern.size;
  return count;
}

void System::place_edges(Configuration& configuration) const {
  for (const Index k : moving_) {
    const auto node = static_cast<std::size_t>(k / 3);
    configuration.positions[node][k % 3] = model_.mesh.nodes[node][k % 3] + configuration.load_factor * model_.move[k];
  }
}

double System::net_pressure(Index block, const Configuration& configuration) const {
  double pressure = at(model_.face_pressure[static_cast<std::size_t>(block)], configuration.load_factor);
  for (std::size_t c = 0; c < model_.chambers.size(); ++c) {
    const double p = configuration.pressures[static_cast<Eigen::Index>(c)];
    if (model_.chambers[c].outer == block) pressure += p; // air below pushes the foil out
    if (model_.chambers[c].inner == block) pressure -= p;
  }
  return pressure;
}

double System::net_pressure_rate(Index block) const {
  const Ramp& face = model_.face_pressure[static_cast<std::size_t>(block)];
  double rate = face[1] - face[0];
  for (std::size_t c = 0; c < model_.chambers.size(); ++c) {
    const double p =
        chamber::prescribed_rate(model_.chambers[static_cast<std::size_t>(air_of(static_cast<Index>(c)))].gas);
    if (model_.chambers[c].outer == block) rate += p;
    if (model_.chambers[c].inner == block) rate -= p;
  }
  return rate;
}

void System::evaluate_foil(FoilEquations& foil, const Configuration& configuration, bool with_tangent) {
  const auto index = static_cast<std::size_t>(&foil - foils_.data());
  const auto coordinates = static_cast<Eigen::Index>(3 * configuration.positions.size());
  foil.pressure = net_pressure(foil.block, configuration);
  foil.volume = 0;
  foil.energy = 0;
  foil.internal.setZero(coordinates);
  foil.external.setZero(coordinates);
  VecX unit = VecX::Zero(coordinates); // force of a unit pressure
  // d force / d load factor of the zones and by what the edges move, at the free positions
  VecX drive = VecX::Zero(coordinates);
  if (with_tangent) foil.tangent.assign(foil.pattern.row.size(), 0.0);

  const std::span<const Index> connectivity = foil.membrane.connectivity;
  geometry::dispatch(model_.mesh.element, [&]<geometry::ElementType E>() {
    constexpr int n = geometry::nodes_per_element(E);
    constexpr int size = 3 * n;
    const auto add = [&](Index e, const double* values, double factor, VecX& target) {
      const Index* node = connectivity.data() + static_cast<std::size_t>(e) * n;
      for (int a = 0; a < n; ++a) {
        for (int c = 0; c < 3; ++c) target[3 * node[a] + c] += factor * values[3 * a + c];
      }
    };
    using ElementMatrix = Eigen::Matrix<double, size, size>;
    // factor * derivative * moves of the element's edges
    const auto add_moves = [&](Index e, const Eigen::Map<const ElementMatrix>& derivative, double factor) {
      if (moving_.empty()) return;
      const Index* node = connectivity.data() + static_cast<std::size_t>(e) * n;
      Eigen::Vector<double, size> move;
      for (int a = 0; a < n; ++a) move.template segment<3>(3 * a) = model_.move.segment<3>(3 * node[a]);
      if (move.isZero(0)) return;
      const Eigen::Vector<double, size> change = derivative * move;
      add(e, change.data(), factor, drive);
    };
    const bool symmetric = material::has_potential(foil.membrane.law);
    failed_[index] =
        element::membrane_forces(foil.membrane, configuration.positions, accepted_[index], new_[index], time_step_,
                                 with_tangent, foil.energy, [&](const element::ElementBatch& batch) {
                                   for (Index e = 0; e < batch.count; ++e) {
                                     add(batch.first + e, batch.force + e * size, 1.0, foil.internal);
                                     if (!with_tangent) continue;
                                     const double* tangent = batch.tangent + e * size * size;
                                     add_moves(batch.first + e, Eigen::Map<const ElementMatrix>(tangent), -1.0);
                                     if (symmetric) {
                                       linear::scatter_add(foil.scatter, batch.first + e, tangent, foil.tangent);
                                       continue;
                                     }
                                     ElementMatrix part = Eigen::Map<const ElementMatrix>(tangent);
                                     symmetrize(part);
                                     linear::scatter_add(foil.scatter, batch.first + e, part.data(), foil.tangent);
                                   }
                                 });
    if (failed_[index]) return;

    geometry::PressureElement<E> p;
    const auto positions_of = [&](Index e) {
      geometry::ElementPositions<E> x = geometry::gather<E>(
          connectivity.subspan(static_cast<std::size_t>(e) * n, static_cast<std::size_t>(n)), configuration.positions);
      x.colwise() -= origin_;
      return x;
    };
    const auto subtract_load_stiffness = [&](Index e, double pressure) {
      add_moves(e, Eigen::Map<const ElementMatrix>(p.derivative.data()), pressure);
      symmetrize(p.derivative);
      p.derivative *= -pressure;
      linear::scatter_add(foil.scatter, e, p.derivative.data(), foil.tangent);
    };
    const Index elements = foil.membrane.reference.element_count();
    for (Index e = 0; e < elements; ++e) {
      const bool stiffness = with_tangent && foil.pressure != 0;
      geometry::pressure_element<E>(positions_of(e), geometry::pressure_rule(E), stiffness, p);
      foil.volume += p.volume;
      add(e, p.force.data(), 1.0, unit);
      if (stiffness) subtract_load_stiffness(e, foil.pressure);
    }
    for (const PressureZone& zone : model_.zones) {
      if (zone.block != foil.block) continue;
      const double pressure = at(zone.pressure, configuration.load_factor);
      for (Index e = 0; e < elements; ++e) {
        const auto begin = static_cast<std::size_t>(zone.offset[static_cast<std::size_t>(e)]);
        const auto end = static_cast<std::size_t>(zone.offset[static_cast<std::size_t>(e) + 1]);
        if (begin == end) continue;
        geometry::pressure_element<E>(positions_of(e), std::span(zone.points).subspan(begin, end - begin), with_tangent,
                                      p);
        add(e, p.force.data(), pressure, foil.external);
        add(e, p.force.data(), zone.pressure[1] - zone.pressure[0], drive);
        if (with_tangent) subtract_load_stiffness(e, pressure);
      }
    }
  });
  if (failed_[index]) return;

  if (with_tangent) {
    double sum = 0;
    for (std::size_t u = 0; u < foil.coordinate.size(); ++u) { // the diagonal ends each column
      const double k = foil.tangent[static_cast<std::size_t>(foil.pattern.column_start[u + 1]) - 1];
      sum += k * k;
    }
    foil.stiffness = std::sqrt(sum);
  }
  foil.external += foil.pressure * unit;
  const auto unknowns = static_cast<Eigen::Index>(foil.coordinate.size());
  foil.residual.resize(unknowns);
  foil.pressure_gradient.resize(unknowns);
  foil.load_gradient.resize(unknowns);
  foil.volume_rate = 0;
  for (const Index k : moving_) foil.volume_rate += unit[k] * model_.move[k];
  const double rate = net_pressure_rate(foil.block);
  const double lambda = configuration.load_factor;
  for (Eigen::Index u = 0; u < unknowns; ++u) {
    const Index k = foil.coordinate[static_cast<std::size_t>(u)];
    foil.external[k] += (1 - lambda) * model_.dead_from[k] + lambda * model_.dead_to[k];
    foil.residual[u] = foil.internal[k] - foil.external[k];
    foil.pressure_gradient[u] = unit[k];
    foil.load_gradient[u] = rate * unit[k] + drive[k] + model_.dead_to[k] - model_.dead_from[k];
  }
}

Balance System::evaluate(Configuration& configuration, bool with_tangent) {
  for (std::size_t c = 0; c < model_.chambers.size(); ++c) {
    double& pressure = configuration.pressures[static_cast<Eigen::Index>(c)];
    pressure = chamber::prescribed_pressure(model_.chambers[c].gas, pressure, configuration.load_factor);
  }
  for (std::size_t c = 0; c < model_.chambers.size(); ++c) { // a duct: one pressure
    const Index air = air_of(static_cast<Index>(c));
    configuration.pressures[static_cast<Eigen::Index>(c)] = configuration.pressures[air];
  }
  place_edges(configuration);
  load_factor_ = configuration.load_factor;
  is_new_ = false;
  base::parallel_chunks(threads_, foils_.size(),
                        [&](std::size_t i) { evaluate_foil(foils_[i], configuration, with_tangent); });

  Balance balance;
  for (std::size_t i = 0; i < foils_.size(); ++i) {
    if (failed_[i]) return {false, why_failed(i, configuration)};
  }
  double residual = 0;
  double internal = 0;
  double external = 0;
  double frame = 0; // all internal forces, those that the frame holds too
  for (const FoilEquations& foil : foils_) {
    residual += foil.residual.squaredNorm();
    frame += foil.internal.squaredNorm();
    for (const Index k : foil.coordinate) {
      internal += foil.internal[k] * foil.internal[k];
      external += foil.external[k] * foil.external[k];
    }
    external += foil.pressure * foil.pressure * foil.pressure_gradient.squaredNorm();
  }
  double largest = 0; // coordinate
  for (const Vec3& x : configuration.positions) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  for (const FoilEquations& foil : foils_) balance.rounding = std::hypot(balance.rounding, foil.stiffness);
  balance.rounding *= std::numeric_limits<double>::epsilon() * largest;
  balance.residual = std::sqrt(residual);
  constexpr double small = 1e-2; // of the frame's forces: where nothing but moved edges stretches a foil
  balance.force_scale = std::sqrt(std::max({internal, external, small * small * frame}));
  if (!std::isfinite(balance.residual)) return {false, "the forces are not finite"};
  for (std::size_t c = 0; c < model_.chambers.size(); ++c) {
    const chamber::GasLine line = gas_line(static_cast<Index>(c), configuration);
    if (!line.possible) return {false, "a chamber's volume or absolute pressure is not positive"};
    if (!std::isfinite(line.relative)) return {false, "a chamber's law is not finite"}; // std::max would drop a NaN
    balance.gas = std::max(balance.gas, std::abs(line.relative));
  }
  is_new_ = true;
  return balance;
}

double System::chamber_volume(Index chamber) const {
  const Chamber& c = model_.chambers[static_cast<std::size_t>(chamber)];
  const auto below = [&](Index block) {
    const Index foil = foil_of_block_[static_cast<std::size_t>(block)];
    return foil < 0 ? base_volume_[static_cast<std::size_t>(block)] : foils_[static_cast<std::size_t>(foil)].volume;
  };
  return below(c.outer) - below(c.inner) + c.dead_volume;
}

double System::chamber_volume_rate(Index chamber) const {
  const Chamber& c = model_.chambers[static_cast<std::size_t>(chamber)];
  double rate = 0;
  for (const FoilEquations& foil : foils_) {
    if (foil.block == c.outer) rate += foil.volume_rate;
    if (foil.block == c.inner) rate -= foil.volume_rate;
  }
  return rate;
}

Index System::air_of(Index chamber) const {
  const Index other = model_.chambers[static_cast<std::size_t>(chamber)].connected_to;
  return other < 0 ? chamber : other;
}

chamber::GasLine System::gas_line(Index chamber, const Configuration& configuration) const {
  if (air_of(chamber) != chamber) return {};
  double volume = 0;
  double rate = 0; // by the load factor as the edges move
  for (std::size_t c = 0; c < model_.chambers.size(); ++c) {
    if (air_of(static_cast<Index>(c)) != chamber) continue;
    volume += chamber_volume(static_cast<Index>(c));
    rate += chamber_volume_rate(static_cast<Index>(c));
  }
  chamber::GasLine line = chamber::gas_line(model_.chambers[static_cast<std::size_t>(chamber)].gas,
                                            configuration.pressures[chamber], volume, configuration.load_factor);
  if (line.pressure_is_unknown) line.drive += rate;
  return line;
}

MatX System::volume_gradients(Index foil) const {
  const FoilEquations& equations = foils_[static_cast<std::size_t>(foil)];
  MatX q = MatX::Zero(equations.pattern.size, static_cast<Eigen::Index>(model_.chambers.size()));
  for (std::size_t c = 0; c < model_.chambers.size(); ++c) {
    const Index air = air_of(static_cast<Index>(c));
    if (model_.chambers[c].outer == equations.block) q.col(air) += equations.pressure_gradient;
    if (model_.chambers[c].inner == equations.block) q.col(air) -= equations.pressure_gradient;
  }
  return q;
}

VecX System::support_forces() const {
  VecX forces = VecX::Zero(model_.dead_from.size());
  for (const FoilEquations& foil : foils_) forces += foil.internal - foil.external;
  for (Eigen::Index k = 0; k < forces.size(); ++k) {
    if (model_.fixed[static_cast<std::size_t>(k)] == 0) {
      forces[k] = 0;
    } else {
      forces[k] -= (1 - load_factor_) * model_.dead_from[k] + load_factor_ * model_.dead_to[k];
    }
  }
  return forces;
}

MatX System::dense_load_stiffness(Index foil, const Configuration& configuration) const {
  const FoilEquations& equations = foils_[static_cast<std::size_t>(foil)];
  std::vector<Index> unknown(configuration.positions.size() * 3, -1);
  for (std::size_t u = 0; u < equations.coordinate.size(); ++u) {
    unknown[static_cast<std::size_t>(equations.coordinate[u])] = static_cast<Index>(u);
  }
  MatX stiffness = MatX::Zero(equations.pattern.size, equations.pattern.size);
  geometry::dispatch(model_.mesh.element, [&]<geometry::ElementType E>() {
    constexpr int n = geometry::nodes_per_element(E);
    geometry::PressureElement<E> p;
    for (Index e = 0; e < equations.membrane.reference.element_count(); ++e) {
      const std::span<const Index> nodes =
          equations.membrane.connectivity.subspan(static_cast<std::size_t>(e) * n, static_cast<std::size_t>(n));
      geometry::pressure_element<E>(geometry::gather<E>(nodes, configuration.positions), geometry::pressure_rule(E),
                                    true, p);
      const auto unknown_at = [&](int i) {
        return unknown[static_cast<std::size_t>(3 * nodes[static_cast<std::size_t>(i / 3)] + i % 3)];
      };
      for (int j = 0; j < 3 * n; ++j) {
        for (int i = 0; i < 3 * n; ++i) {
          if (unknown_at(i) >= 0 && unknown_at(j) >= 0) stiffness(unknown_at(i), unknown_at(j)) += p.derivative(i, j);
        }
      }
    }
  });
  return stiffness;
}

std::string System::why_failed(std::size_t foil, const Configuration& configuration) const {
  const FoilEquations& equations = foils_[foil];
  const element::Failed& failed = *failed_[foil];
  const geometry::Block& block = model_.mesh.blocks[static_cast<std::size_t>(equations.block)];
  Vec3 middle = Vec3::Zero();
  const std::span<const Index> nodes = model_.mesh.element_nodes(block, failed.element);
  for (const Index node : nodes) {
    middle += configuration.positions[static_cast<std::size_t>(node)] / static_cast<double>(nodes.size());
  }
  const Vec3& e = failed.strain;
  const std::string strain = fmt::format("({:.4g}, {:.4g}, {:.4g})", e[0], e[1], 0.5 * e[2]);
  const std::string place = base::place_text(middle) + " m";
  if (failed.status != material::Status::outside_data) {
    return fmt::format("the material of foil `{}` has no state at strain {} at {}", block.name, strain, place);
  }
  const material::StrainRange data =
      material::data_range(model_.foils[static_cast<std::size_t>(equations.block)]->law).value();
  return fmt::format(
      "the material of foil `{}` has no data at strain {} at {}: its table lies within {:.4g} and {:.4g}", block.name,
      strain, place, data.min, data.max);
}

void System::accept_history() {
  if (!std::exchange(is_new_, false)) return; // a second time it would hide the step before
  before_.swap(accepted_);
  accepted_ = new_; // which stays: that of the last evaluation
  accepted_time_step_ = time_step_;
}

Balance System::evaluate_accepted(Configuration& configuration, bool with_tangent) {
  const auto swap = [this] {
    before_.swap(accepted_);
    std::swap(time_step_, accepted_time_step_);
  };
  swap();
  Balance balance = evaluate(configuration, with_tangent);
  is_new_ = false;
  swap();
  return balance;
}

void System::restore(Memory memory) {
  before_ = std::move(memory.before);
  accepted_ = std::move(memory.accepted);
  time_step_ = memory.time_step;
  accepted_time_step_ = memory.accepted_time_step;
  is_new_ = false;
}

bool System::flows_with_time() const {
  return time_step_ > 0 && std::ranges::any_of(foils_, [](const FoilEquations& foil) {
           return material::is_rate_dependent(foil.membrane.law);
         });
}

System::Flow System::flow() const {
  Flow largest;
  for (std::size_t f = 0; f < foils_.size(); ++f) {
    const material::Law& law = foils_[f].membrane.law;
    const std::span<const std::string_view> names = material::history_names(law);
    const auto which =
        static_cast<std::size_t>(std::ranges::find(names, material::equivalent_plastic_strain) - names.begin());
    if (which == names.size()) continue;
    const bool in_time = material::is_rate_dependent(law) && time_step_ > 0;
    const double ratio = accepted_time_step_ > 0 ? time_step_ / accepted_time_step_ : 0.0;
    for (std::size_t i = which; i < accepted_[f].size(); i += names.size()) {
      const double growth = new_[f][i] - accepted_[f][i];
      largest.growth = std::max(largest.growth, growth);
      if (!in_time) continue;
      const double foreseen = ratio * (accepted_[f][i] - before_[f][i]);
      largest.error = std::max(largest.error, 0.5 * std::abs(growth - foreseen));
    }
  }
  return largest;
}

} // namespace pneuma::solver::assembly
