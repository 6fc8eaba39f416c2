// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "geometry/base/namespace.h"

namespace pneuma::geometry::base {

using Index = std::int32_t; // number of a node, an element, a degree of freedom

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;
using Mat32 = Eigen::Matrix<double, 3, 2>;
using VecX = Eigen::VectorXd;
using MatX = Eigen::MatrixXd;

} // namespace pneuma::geometry::base
