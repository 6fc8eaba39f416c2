// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/drawing/drawing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pneuma::pipeline::drawing {

namespace {

// Letters, not bytes, of UTF-8.
std::ptrdiff_t letters(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

} // namespace

double width(const Text& text) {
  return letter_width * text.height * static_cast<double>(letters(text.text));
}

Extent extent(const Drawing& drawing) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Extent all = {Vec2(far, far), Vec2(-far, -far)};
  const auto include = [&](const Vec2& point) {
    all.low = all.low.cwiseMin(point);
    all.high = all.high.cwiseMax(point);
  };
  for (const Polyline& line : drawing.lines) std::for_each(line.points.begin(), line.points.end(), include);
  for (const Text& text : drawing.texts) {
    const Vec2 along(std::cos(text.angle), std::sin(text.angle));
    const Vec2 up(-along.y(), along.x());
    for (const Vec2& foot : {text.at, Vec2(text.at + width(text) * along)}) {
      include(foot);
      include(foot + text.height * up);
    }
  }
  if (all.low.x() > all.high.x()) return {Vec2::Zero(), Vec2::Zero()};
  return all;
}

} // namespace pneuma::pipeline::drawing
