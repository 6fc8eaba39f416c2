// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/places.h"

namespace pneuma::tests {

const char* const source_folder = PNEUMA_SOURCE_FOLDER;
const char* const program_folder = PNEUMA_PROGRAM_FOLDER;

} // namespace pneuma::tests
