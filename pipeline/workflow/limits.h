// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/outline.h"
#include "pipeline/workflow/mesh.h"

// How large a cushion may be: beyond these numbers a slip of the pen is likelier than a wish.
namespace pneuma::pipeline::workflow {

inline constexpr int most_strips = 200;       // a foil
inline constexpr double most_elements = 5e6;  // a foil
inline constexpr double memory_a_node = 9000; // bytes, of an equilibrium; measured with 2e4 to 6e5 nodes: 7000 to 8300

struct MeshEstimate {
  double elements = 0, nodes = 0; // a foil
};

// Within a third of what the mesh will have where the elements are small against the plan.
MeshEstimate estimate(const geometry::Plan& plan, const MeshSettings& mesh);

// What a program may take here: of the machine, or less by a limit of the process (ulimit -v); bytes.
double machine_memory();

} // namespace pneuma::pipeline::workflow
