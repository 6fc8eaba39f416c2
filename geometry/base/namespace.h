// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pneuma::geometry::base {}

namespace pneuma {
namespace base = geometry::base; // short: everybody uses it
}
