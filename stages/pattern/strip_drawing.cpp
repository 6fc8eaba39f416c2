// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/strip_drawing.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "geometry/polygon.h"

namespace pneuma::stages::pattern {

namespace {

using base::Vec2;
using geometry::fabrication::CutStrip;
using geometry::fabrication::FlatStrip;
using geometry::fabrication::Notch;
using geometry::fabrication::Placement;
using geometry::fabrication::Side;
using pipeline::drawing::Drawing;
using pipeline::drawing::Text;
using pipeline::drawing::text_width;

constexpr double largest_letter = 0.04;   // m
constexpr double smallest_letter = 0.001; // m
constexpr double same_height = 1e-6;      // m

Vec2 up_from(const Vec2& along) {
  return {-along.y(), along.x()};
}

// 0, -1, 1, -2, 2, ...
int to_both_sides(int k) {
  return (k % 2 == 0 ? 1 : -1) * ((k + 1) / 2);
}

// A rectangle in any direction; a line if one half size is zero.
struct Box {
  Vec2 centre, along, half;

  double reach(const Vec2& axis) const {
    return half.x() * std::abs(axis.dot(along)) + half.y() * std::abs(axis.dot(up_from(along)));
  }
};

Box line_box(const Vec2& from, const Vec2& to) {
  return {(from + to) / 2, (to - from).normalized(), {(to - from).norm() / 2, 0}};
}

bool overlap(const Box& a, const Box& b) {
  const Vec2 between = b.centre - a.centre;
  for (const Vec2& axis : {a.along, up_from(a.along), b.along, up_from(b.along)}) {
    if (std::abs(axis.dot(between)) > a.reach(axis) + b.reach(axis)) return false;
  }
  return true;
}

bool inside(const std::vector<Vec2>& ring, const Box& box) {
  if (!geometry::contains(ring, box.centre)) return false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (overlap(box, line_box(ring[i], ring[(i + 1) % ring.size()]))) return false;
  }
  return true;
}

// A text about its centre, along a direction that is turned round where it would stand on its head.
Text centred(const std::string& letters, const Vec2& centre, Vec2 along, double height) {
  if (along.x() < -1e-9 || (along.x() < 1e-9 && along.y() < 0)) along = -along;
  Text text = {"TEXT", centre, height, std::atan2(along.y(), along.x()), letters};
  text.at -= text_width(letters, height) / 2 * along + height / 2 * up_from(along);
  return text;
}

Box box_of(const Text& text) {
  const Vec2 along(std::cos(text.angle), std::sin(text.angle));
  const double half_width = text_width(text.text, text.height) / 2;
  const double clearance = 0.2 * text.height;
  return {text.at + half_width * along + text.height / 2 * up_from(along),
          along,
          {half_width + clearance, text.height / 2 + clearance}};
}

// The middle of the widest stretch of a vertical line inside a ring.
std::optional<Vec2> middle_at(const std::vector<Vec2>& ring, double x) {
  std::vector<double> crossings;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2& a = ring[i];
    const Vec2& b = ring[(i + 1) % ring.size()];
    if ((a.x() > x) != (b.x() > x)) crossings.push_back(a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
  }
  std::sort(crossings.begin(), crossings.end());
  double widest = 0;
  std::optional<Vec2> middle;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    if (crossings[i + 1] - crossings[i] <= widest) continue;
    widest = crossings[i + 1] - crossings[i];
    middle = Vec2(x, (crossings[i] + crossings[i + 1]) / 2);
  }
  return middle;
}

// Where the points of a ring that are extreme in one coordinate come closest to a value of the other.
double at_extreme(const std::vector<Vec2>& ring, int coordinate, double extreme, double wanted) {
  double low = 1e300;
  double high = -1e300;
  for (const Vec2& point : ring) {
    if (std::abs(point[coordinate] - extreme) > same_height) continue;
    low = std::min(low, point[1 - coordinate]);
    high = std::max(high, point[1 - coordinate]);
  }
  return std::clamp(wanted, low, high);
}

// A strip on the roll, and what has already been written on it.
class Sheet {
public:
  Sheet(const FlatStrip& flat, const CutStrip& cut, const Placement& placement, double notch_length, Drawing& drawing)
      : flat_(flat), cut_(cut), placement_(placement), notch_length_(notch_length), drawing_(drawing) {
    for (const Vec2& point : cut.net) net_.push_back(placement(point));
    for (const Vec2& point : cut.outline) outline_.push_back(placement(point));
    low_ = placement(cut.low);
    high_ = placement(cut.high);
  }

  void draw() {
    drawing_.lines.push_back({"CUT", true, outline_});
    drawing_.lines.push_back({"NET", true, net_});
    draw_middle();
    for (const Notch& notch : cut_.notches) draw_notch(notch);
    for (const Side& side : flat_.sides) label(side);
  }

private:
  // Half the size of the block of name, roll direction and dimensions, in letters' heights.
  Vec2 half_block() const {
    const double name = text_width(flat_.name, 2) / 2;
    return {std::max(name, 7.0) + 1.5, 4.4};
  }

  // The largest letters with which the block fits, and its centre; as near to the middle of the strip as can be.
  std::pair<Vec2, double> find_middle() const {
    constexpr int places = 24; // to either side
    const Vec2 size = high_ - low_;
    const Vec2 centre = (low_ + high_) / 2;
    for (double letter = std::min(largest_letter, size.minCoeff() / 12); letter > smallest_letter; letter *= 0.9) {
      for (int k = 0; k < 2 * places; ++k) {
        const double shift = to_both_sides(k) * size.x() / (2 * places);
        const auto middle = middle_at(net_, centre.x() + shift);
        if (middle && inside(net_, {*middle, Vec2::UnitX(), letter * half_block()})) return {*middle, letter};
      }
    }
    return {middle_at(net_, centre.x()).value_or(centre), smallest_letter};
  }

  // From the top: the name, the roll direction, the length; at the right the width.
  void draw_middle() {
    const auto [centre, letter] = find_middle();
    letter_ = letter;
    const double half = letter * (half_block().x() - 1.5);
    const Vec2 middle = centre - Vec2(letter, 0);
    const Vec2 x = Vec2::UnitX();
    const Vec2 y = Vec2::UnitY();
    taken_.push_back({centre, x, letter * half_block()});
    drawing_.texts.push_back(centred(flat_.name, middle + 3.3 * letter * y, x, 2 * letter));
    drawing_.texts.push_back(centred("ROLL DIRECTION", middle + letter * y, x, 0.8 * letter));
    line("WARP", middle - half * x, middle + half * x);
    head("WARP", middle + half * x, x);
    dimension_length(middle - 2.7 * letter * y);
    dimension_width(middle + half * x + 2 * letter * x + 0.8 * letter * y);
  }

  void line(const char* layer, const Vec2& from, const Vec2& to) {
    if ((to - from).norm() <= same_height) return;
    drawing_.lines.push_back({layer, false, {from, to}});
    taken_.push_back(line_box(from, to));
  }

  void head(const char* layer, const Vec2& tip, const Vec2& along) {
    const Vec2 barb = 0.25 * letter_ * up_from(along);
    const Vec2 back = tip - 0.8 * letter_ * along;
    drawing_.lines.push_back({layer, false, {back + barb, tip, back - barb}});
  }

  // A line with an arrow at both ends and its length, in mm, beside the foot of `text`.
  void dimension(const Vec2& from, const Vec2& to, const Vec2& text) {
    const Vec2 along = (to - from).normalized();
    line("DIM", from, to);
    head("DIM", from, -along);
    head("DIM", to, along);
    const Vec2 foot = from + along.dot(text - from) * along;
    Text number =
        centred(fmt::format("{:.1f}", 1e3 * (to - from).norm()), foot + 0.8 * letter_ * up_from(along), along, letter_);
    number.layer = "DIM";
    drawing_.texts.push_back(number);
    taken_.push_back(box_of(number));
  }

  void dimension_length(const Vec2& at) {
    for (const double end : {low_.x(), high_.x()}) {
      line("DIM", {end, at_extreme(outline_, 0, end, at.y())}, {end, at.y()});
    }
    dimension({low_.x(), at.y()}, {high_.x(), at.y()}, at);
  }

  void dimension_width(const Vec2& at) {
    for (const double end : {low_.y(), high_.y()}) {
      line("DIM", {at_extreme(outline_, 1, end, at.x()), end}, {at.x(), end});
    }
    dimension({at.x(), low_.y()}, {at.x(), high_.y()}, at);
  }

  bool free(const Text& text) const {
    const Box box = box_of(text);
    return inside(net_, box) &&
           std::none_of(taken_.begin(), taken_.end(), [&](const Box& other) { return overlap(box, other); });
  }

  // The first of the texts that has room, at the largest size; the last and smallest where none has.
  template <class TextAt>
  void write(int places, double height, const TextAt& text_at) {
    Text text;
    for (const double size : {1.0, 0.7, 0.5, 0.35}) {
      for (int place = 0; place < places; ++place) {
        text = text_at(place, size * height);
        if (!free(text)) continue;
        drawing_.texts.push_back(text);
        taken_.push_back(box_of(text));
        return;
      }
    }
    drawing_.texts.push_back(text);
  }

  void draw_notch(const Notch& notch) {
    const Vec2 inwards = notch.inwards;
    const Vec2 at = placement_(notch.at);
    const Vec2 end = at + notch_length_ * inwards;
    line("NOTCH", at, end);
    write(2, 0.3 * letter_, [&](int place, double height) {
      const Vec2 along = (place == 0 ? 1 : -1) * up_from(inwards);
      const double half = text_width(notch.name, height) / 2;
      return centred(notch.name, end + (half + 0.3 * height) * along + 0.8 * height * inwards, along, height);
    });
  }

  // A point of a side on the roll and the direction there.
  std::pair<Vec2, Vec2> point_on(const Side& side, double fraction) const {
    double left = fraction * length(side);
    for (std::size_t i = 0; i + 1 < side.points.size(); ++i) {
      const Vec2 step = placement_(side.points[i + 1]) - placement_(side.points[i]);
      if (left <= step.norm() || i + 2 == side.points.size()) {
        return {placement_(side.points[i]) + left * step.normalized(), step.normalized()};
      }
      left -= step.norm();
    }
    return {};
  }

  // Once in the middle of a short side, near both ends of a long one.
  void label(const Side& side) {
    const std::string letters = side.seam ? fmt::format("{} TO {}", side.name, side.mate) : side.name;
    const double height = 0.6 * letter_;
    const bool is_long = length(side) > 6 * text_width(letters, height);
    const auto along_side = [&](double middle, double spread) {
      constexpr int places = 13;
      write(places, height, [&](int place, double h) {
        const double shift = to_both_sides(place) * spread / (places - 1);
        const auto [at, along] = point_on(side, middle + shift);
        return centred(letters, at + 1.1 * h * up_from(along), along, h);
      });
    };
    if (is_long) {
      along_side(0.25, 0.3);
      along_side(0.75, 0.3);
    } else {
      along_side(0.5, 0.8);
    }
  }

  const FlatStrip& flat_;
  const CutStrip& cut_;
  const Placement& placement_;
  double notch_length_;
  Drawing& drawing_;
  std::vector<Vec2> net_, outline_; // on the roll
  Vec2 low_, high_;                 // of the cut on the roll
  double letter_ = 0;               // height of most letters, m
  std::vector<Box> taken_;
};

} // namespace

std::vector<pipeline::drawing::Layer> strip_layers() {
  return {{"CUT", 7}, {"NET", 5}, {"NOTCH", 1}, {"TEXT", 3}, {"WARP", 6}, {"DIM", 8}};
}

void draw_strip(const FlatStrip& flat, const CutStrip& cut, const Placement& placement, double notch_length,
                Drawing& drawing) {
  Sheet(flat, cut, placement, notch_length, drawing).draw();
}

void draw_roll(double length, double width, double selvedge, Drawing& drawing) {
  drawing.lines.push_back({"DIM", true, {{0, 0}, {length, 0}, {length, width}, {0, width}}});
  if (selvedge > 0) {
    drawing.lines.push_back({"DIM", false, {{0, selvedge}, {length, selvedge}}});
    drawing.lines.push_back({"DIM", false, {{0, width - selvedge}, {length, width - selvedge}}});
  }
  const double letter = std::min(largest_letter, width / 20);
  const std::string size = fmt::format("ROLL {:.0f} mm, {:.0f} mm USED", 1e3 * width, 1e3 * length);
  drawing.texts.push_back({"DIM", {0, width + letter}, letter, 0, fmt::format("{}: {}", drawing.title, size)});
}

void draw_plan_centre(const Vec2& centre, double width, Drawing& drawing) {
  const double letter = std::min(largest_letter, width / 20) / 2; // clear of the line above, which is longer
  drawing.texts.push_back({"DIM",
                           {0, width + letter / 2},
                           letter,
                           0,
                           fmt::format("PLAN CENTRE AT {:.3f}, {:.3f} m", centre.x(), centre.y())});
}

} // namespace pneuma::stages::pattern
