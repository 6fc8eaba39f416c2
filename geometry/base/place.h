// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "geometry/base/types.h"

namespace pneuma::geometry::base {

// "(1.5, -2, 0.25)": a place in a message, m, in the user's coordinates.
std::string place_text(const Vec2& place);
std::string place_text(const Vec3& place);

// Where the coordinates that a program computes in begin, in the user's, m; zero until it is said. For main functions:
// it changes nothing but messages.
void tell_places_from(const Vec3& origin);

} // namespace pneuma::geometry::base
