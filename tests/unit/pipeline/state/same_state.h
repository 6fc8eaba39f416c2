// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <ios>

#include <gtest/gtest.h>

#include "pipeline/state/state.h"

namespace pneuma::tests {

// Numbers are compared by their bits, so that a NaN equals itself and -0 differs from 0.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same(const pipeline::state::State& a, const pipeline::state::State& b) {
  EXPECT_EQ(a.provenance.program, b.provenance.program);
  EXPECT_EQ(a.provenance.stage_kind, b.provenance.stage_kind);
  EXPECT_EQ(a.provenance.stage_id, b.provenance.stage_id);
  EXPECT_EQ(a.provenance.inputs, b.provenance.inputs);
  EXPECT_EQ(a.provenance.settings, b.provenance.settings);
  EXPECT_EQ(a.provenance.verdict, b.provenance.verdict);
  EXPECT_EQ(a.provenance.converged, b.provenance.converged);
  EXPECT_TRUE(same_bits(a.provenance.load_factor, b.provenance.load_factor));
  EXPECT_EQ(a.mesh.element, b.mesh.element);
  EXPECT_EQ(a.stress_rule, b.stress_rule);
  ASSERT_EQ(a.mesh.nodes.size(), b.mesh.nodes.size());
  for (std::size_t i = 0; i < a.mesh.nodes.size(); ++i) {
    EXPECT_EQ(std::memcmp(a.mesh.nodes[i].data(), b.mesh.nodes[i].data(), 3 * sizeof(double)), 0) << "node " << i;
  }
  ASSERT_EQ(a.mesh.blocks.size(), b.mesh.blocks.size());
  for (std::size_t i = 0; i < a.mesh.blocks.size(); ++i) {
    EXPECT_EQ(a.mesh.blocks[i].name, b.mesh.blocks[i].name);
    EXPECT_EQ(a.mesh.blocks[i].kind, b.mesh.blocks[i].kind);
    EXPECT_EQ(a.mesh.blocks[i].connectivity, b.mesh.blocks[i].connectivity);
  }
  ASSERT_EQ(a.mesh.edges.size(), b.mesh.edges.size());
  for (std::size_t i = 0; i < a.mesh.edges.size(); ++i) {
    EXPECT_EQ(a.mesh.edges[i].name, b.mesh.edges[i].name);
    EXPECT_EQ(a.mesh.edges[i].closed, b.mesh.edges[i].closed);
    EXPECT_EQ(a.mesh.edges[i].nodes, b.mesh.edges[i].nodes);
  }
  ASSERT_EQ(a.foils.size(), b.foils.size());
  for (std::size_t i = 0; i < a.foils.size(); ++i) {
    EXPECT_EQ(a.foils[i].material, b.foils[i].material);
    EXPECT_TRUE(same_bits(a.foils[i].thickness, b.foils[i].thickness));
    EXPECT_TRUE(same_bits(a.foils[i].warp_angle, b.foils[i].warp_angle));
    EXPECT_TRUE(same_bits(a.foils[i].reference, b.foils[i].reference));
    EXPECT_TRUE(same_bits(a.foils[i].predeformation, b.foils[i].predeformation));
    EXPECT_TRUE(same_bits(a.foils[i].prestress, b.foils[i].prestress));
    EXPECT_TRUE(same_bits(a.foils[i].history, b.foils[i].history));
    EXPECT_EQ(a.foils[i].history_names, b.foils[i].history_names);
    EXPECT_EQ(a.foils[i].strips, b.foils[i].strips);
    EXPECT_EQ(a.foils[i].strip_of_element, b.foils[i].strip_of_element);
    ASSERT_EQ(a.foils[i].seams.size(), b.foils[i].seams.size());
    for (std::size_t k = 0; k < a.foils[i].seams.size(); ++k) {
      EXPECT_EQ(a.foils[i].seams[k].name, b.foils[i].seams[k].name);
      EXPECT_EQ(a.foils[i].seams[k].left, b.foils[i].seams[k].left);
      EXPECT_EQ(a.foils[i].seams[k].right, b.foils[i].seams[k].right);
      EXPECT_EQ(a.foils[i].seams[k].nodes, b.foils[i].seams[k].nodes);
    }
  }
  EXPECT_EQ(a.fixed, b.fixed);
  ASSERT_EQ(a.chambers.size(), b.chambers.size());
  for (std::size_t i = 0; i < a.chambers.size(); ++i) {
    const pipeline::state::Chamber& p = a.chambers[i];
    const pipeline::state::Chamber& q = b.chambers[i];
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.outer, q.outer);
    EXPECT_EQ(p.inner, q.inner);
    EXPECT_EQ(p.law, q.law);
    EXPECT_EQ(p.connected_to, q.connected_to);
    EXPECT_TRUE(same_bits(p.dead_volume, q.dead_volume));
    EXPECT_TRUE(same_bits(p.kappa, q.kappa));
    EXPECT_TRUE(same_bits(p.gauge_pressure, q.gauge_pressure));
    EXPECT_TRUE(same_bits(p.ambient_pressure, q.ambient_pressure));
    EXPECT_TRUE(same_bits(p.temperature, q.temperature));
    EXPECT_TRUE(same_bits(p.volume, q.volume));
  }
  ASSERT_EQ(a.loads.size(), b.loads.size());
  for (std::size_t i = 0; i < a.loads.size(); ++i) {
    const pipeline::state::Load& p = a.loads[i];
    const pipeline::state::Load& q = b.loads[i];
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.block, q.block);
    EXPECT_EQ(p.offset, q.offset);
    EXPECT_TRUE(same_bits(p.pressure, q.pressure));
    EXPECT_TRUE(same_bits(p.dead, q.dead));
    ASSERT_EQ(p.points.size(), q.points.size());
    for (std::size_t k = 0; k < p.points.size(); ++k) {
      EXPECT_TRUE(same_bits(p.points[k].xi, q.points[k].xi));
      EXPECT_TRUE(same_bits(p.points[k].eta, q.points[k].eta));
      EXPECT_TRUE(same_bits(p.points[k].weight, q.points[k].weight));
    }
  }
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t i = 0; i < a.fields.size(); ++i) {
    EXPECT_EQ(a.fields[i].name, b.fields[i].name);
    EXPECT_EQ(a.fields[i].unit, b.fields[i].unit);
    EXPECT_EQ(a.fields[i].location, b.fields[i].location);
    EXPECT_EQ(a.fields[i].components, b.fields[i].components);
    EXPECT_EQ(a.fields[i].block, b.fields[i].block);
    EXPECT_TRUE(same_bits(a.fields[i].values, b.fields[i].values));
  }
}

} // namespace pneuma::tests
