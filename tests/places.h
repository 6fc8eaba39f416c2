// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pneuma::tests {

// Folders of this build. Their names stand in places.cpp alone: what the compiler reads of every other file is the same
// in another clone, and its cache serves there.
extern const char* const source_folder;  // the top of the sources
extern const char* const program_folder; // pneuma and the stages

} // namespace pneuma::tests
