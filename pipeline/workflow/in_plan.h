// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/settings.h"

// What stages say about places and lengths in the plan, held against it: what lies beside the foil, and what asks for
// more elements or strips than there can be, needs no mesh to be seen.
namespace pneuma::pipeline::workflow {

// Of complete settings, of a plan without fault; every problem stands at the key that says it.
void check_in_plan(Reader& reader, const Cushion& cushion, const At<MeshSettings>& mesh);
void check_in_plan(Reader& reader, const geometry::Plan& plan, const At<PatternSettings>& pattern,
                   const MeshSettings* mesh); // nullptr: not known
void check_in_plan(Reader& reader, const geometry::Plan& plan, const At<PathSettings>& path);
void check_in_plan(Reader& reader, const geometry::Plan& plan, const At<WindSettings>& wind);

} // namespace pneuma::pipeline::workflow
