// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/base/types.h"

namespace pneuma::geometry::flattening {

using base::Vec2;

// The points, moved and turned as a whole to lie nearest to as many targets (least sum of squared distances; Kabsch
// 1976 in the plane, without mirroring).
std::vector<Vec2> laid_over(std::span<const Vec2> points, std::span<const Vec2> targets);

} // namespace pneuma::geometry::flattening
