// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/outline.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::stages::common {

// The workflow with the plan and all that lies on it (regions, patches, curves, a controlled point) in local
// coordinates.
pipeline::workflow::Workflow to_local(pipeline::workflow::Workflow workflow, const geometry::LocalFrame& frame);

} // namespace pneuma::stages::common
