// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/drawing/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "pipeline/drawing/drawing.h"
#include "pipeline/drawing/xml.h"
#include "pipeline/files/file.h"

namespace pneuma::pipeline::drawing {

namespace {

// px
constexpr double page_width = 720, page_height = 450;
constexpr double font = 13, title_font = 15;
constexpr double mark_size = 4;
constexpr double gap = 10; // between neighbouring things
constexpr double tick_length = 5, minor_length = 3;
constexpr double swatch = 32; // of a curve in the legend
constexpr const char* ink = "#222222";
constexpr const char* grid = "#e4e4e4";

// Okabe and Ito (2008), Color universal design; their yellow, which white swallows, is left out
const char* colour(int index) {
  static const std::array<const char*, 8> colours = {"#000000", "#0072b2", "#d55e00", "#009e73",
                                                     "#cc79a7", "#e69f00", "#56b4e9", "#808080"};
  const auto count = static_cast<int>(colours.size());
  const int shown = index < count ? std::max(index, 0) : 1 + (index - 1) % (count - 2);
  return colours[static_cast<std::size_t>(shown)];
}

struct Tick {
  double value = 0;
  std::string label; // none: a minor tick
};

// An axis as it is drawn: `low` and `high` at its ends, in px from `start` to `end`.
struct Ruler {
  Scale scale = Scale::linear;
  double low = 0, high = 1;
  double start = 0, end = 1;
  std::vector<Tick> ticks;

  double measure(double value) const { return scale == Scale::logarithmic ? std::log10(value) : value; }
  double at(double value) const {
    return start + (end - start) * (measure(value) - measure(low)) / (measure(high) - measure(low));
  }
};

std::string superscript(int number) {
  static const std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string result = number < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(number))) result += digits[static_cast<std::size_t>(c - '0')];
  return result;
}

std::string power_label(int factor, int exponent) {
  if (exponent >= 0 && exponent <= 3) return fmt::format("{}", factor * std::lround(std::pow(10, exponent)));
  return factor == 1 ? "10" + superscript(exponent) : fmt::format("{}·10{}", factor, superscript(exponent));
}

// Steps of 1, 2 or 5 times a power of ten, four to ten of them.
double step_of(double span) {
  const double power = std::pow(10, std::floor(std::log10(span / 4)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= span / 4) return factor * power;
  }
  return power;
}

std::string linear_label(double value, double step, double largest) {
  if (largest >= 1e6 || step < 1e-5) return fmt::format("{:.10g}", value);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value, decimals);
}

void place_linear_ticks(Ruler& ruler, bool to_ticks) {
  const double step = step_of(ruler.high - ruler.low);
  constexpr double rounding = 1e-9; // of a step
  double first = std::ceil(ruler.low / step - rounding), last = std::floor(ruler.high / step + rounding);
  if (to_ticks) {
    first = std::floor(ruler.low / step + rounding);
    last = std::ceil(ruler.high / step - rounding);
    ruler.low = first * step;
    ruler.high = last * step;
  }
  const double largest = std::max(std::abs(ruler.low), std::abs(ruler.high));
  const int count = static_cast<int>(last - first);
  for (int i = 0; i <= count; ++i) {
    const double value = (first + i) * step + 0.0; // no -0
    ruler.ticks.push_back({value, linear_label(value, step, largest)});
  }
}

void place_logarithmic_ticks(Ruler& ruler) {
  const int first = static_cast<int>(std::floor(std::log10(ruler.low)));
  const int last = static_cast<int>(std::floor(std::log10(ruler.high)));
  const double decades = std::log10(ruler.high / ruler.low);
  const int every = 1 + static_cast<int>(decades / 9); // decade has a label
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int factor = 1; factor < 10; ++factor) {
      const double value = factor * std::pow(10, exponent);
      if (value < ruler.low * (1 - 1e-9) || value > ruler.high * (1 + 1e-9)) continue;
      const bool between = factor == 2 || factor == 5; // labelled where there are few whole decades
      const bool labelled = factor == 1 ? exponent % every == 0 : between && decades < 2;
      if (!labelled && factor > 1 && decades > 9) continue;
      ruler.ticks.push_back({value, labelled ? power_label(factor, exponent) : ""});
    }
  }
}

[[noreturn]] void refuse(const Chart& chart, const std::string& why) {
  throw std::invalid_argument(fmt::format("chart \"{}\": {}", chart.title, why));
}

// The axis of one coordinate of all points; its place on the page comes later.
Ruler ruler_of(const Chart& chart, const Axis& axis, int coordinate) {
  Ruler ruler;
  ruler.scale = axis.scale;
  ruler.low = std::numeric_limits<double>::infinity();
  ruler.high = -ruler.low;
  const bool logarithmic = axis.scale == Scale::logarithmic;
  for (const Curve& curve : chart.curves) {
    for (const Vec2& point : curve.points) {
      const double value = point[coordinate];
      if (!std::isfinite(value)) refuse(chart, "a point of \"" + curve.name + "\" is not finite");
      if (logarithmic && value <= 0) refuse(chart, "a point of \"" + curve.name + "\" has no logarithm");
      ruler.low = std::min(ruler.low, value);
      ruler.high = std::max(ruler.high, value);
    }
  }
  if (ruler.low > ruler.high) refuse(chart, "no point to show");
  if (axis.range) {
    ruler.low = (*axis.range)[0];
    ruler.high = (*axis.range)[1];
    if (!(ruler.low < ruler.high) || (logarithmic && !(ruler.low > 0))) {
      refuse(chart, "the range of \"" + axis.label + "\" is empty");
    }
  } else if (logarithmic) {
    const double room = std::pow(ruler.high / ruler.low, 0.04) * (ruler.low == ruler.high ? 2 : 1);
    ruler.low /= room;
    ruler.high *= room;
  } else if (ruler.low == ruler.high) {
    const double room = ruler.low == 0 ? 1 : 0.5 * std::abs(ruler.low);
    ruler.low -= room;
    ruler.high += room;
  }
  const bool less_than_five_times = ruler.high < 5 * ruler.low; // perhaps none of 1, 2 and 5 lies in it
  if (logarithmic && !less_than_five_times) {
    place_logarithmic_ticks(ruler);
  } else {
    place_linear_ticks(ruler, !axis.range && !logarithmic);
  }
  return ruler;
}

// px; `letter_width` is of a capital's height
double width_of(const std::string& text) {
  return text_width(text, capital_height * font);
}

template <class... Args>
void add(std::string& out, fmt::format_string<Args...> text, Args&&... args) {
  fmt::format_to(std::back_inserter(out), text, std::forward<Args>(args)...);
}

void write_text(const Vec2& at, const char* anchor, const std::string& text, std::string& out) {
  add(out, "<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"{}\">{}</text>\n", at.x(), at.y(), anchor, escaped(text));
}

void write_segment(const Vec2& a, const Vec2& b, const char* stroke, std::string& out) {
  add(out, "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" stroke=\"{}\"/>\n", a.x(), a.y(), b.x(), b.y(), stroke);
}

void write_polygon(const Vec2& at, std::initializer_list<Vec2> corners, std::string& out) {
  out += "<polygon points=\"";
  for (const Vec2& corner : corners) {
    const Vec2 p = at + mark_size * corner;
    add(out, "{:.2f},{:.2f} ", p.x(), p.y());
  }
  out.back() = '"';
  out += "/>\n";
}

void write_mark(Mark mark, const Vec2& at, std::string& out) {
  switch (mark) {
  case Mark::none:
    break;
  case Mark::circle:
    add(out, "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\"/>\n", at.x(), at.y(), mark_size);
    break;
  case Mark::square:
    write_polygon(at, {{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}}, out);
    break;
  case Mark::triangle:
    write_polygon(at, {{0, -1.2}, {1.1, 0.8}, {-1.1, 0.8}}, out);
    break;
  case Mark::diamond:
    write_polygon(at, {{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}}, out);
    break;
  }
}

const char* dashes(Stroke stroke) {
  switch (stroke) {
  case Stroke::dashed:
    return " stroke-dasharray=\"7 4\"";
  case Stroke::dotted:
    return " stroke-dasharray=\"1.5 3.5\"";
  default:
    return "";
  }
}

// The line of a curve through points on the page, which one user unit a px has.
void write_line(const Curve& curve, const std::vector<Vec2>& points, std::string& out) {
  if (curve.stroke == Stroke::none || points.size() < 2) return;
  add(out, "<polyline fill=\"none\" stroke-width=\"1.6\" stroke=\"{}\"{} points=\"", colour(curve.colour),
      dashes(curve.stroke));
  for (const Vec2& point : points) add(out, "{:.2f},{:.2f} ", point.x(), point.y());
  out.back() = '"';
  out += "/>\n";
}

void write_axes(const Chart& chart, const Ruler& x, const Ruler& y, std::string& out) {
  const Vec2 size(x.end - x.start, y.start - y.end);
  out += "<g font-size=\"" + fmt::format("{:g}", font) + "\">\n";
  for (const Tick& tick : x.ticks) {
    const double at = x.at(tick.value);
    if (!tick.label.empty()) write_segment({at, y.start}, {at, y.end}, grid, out);
  }
  for (const Tick& tick : y.ticks) {
    const double at = y.at(tick.value);
    if (!tick.label.empty()) write_segment({x.start, at}, {x.end, at}, grid, out);
  }
  for (const Tick& tick : x.ticks) {
    const double at = x.at(tick.value);
    write_segment({at, y.start}, {at, y.start + (tick.label.empty() ? minor_length : tick_length)}, ink, out);
    if (!tick.label.empty()) write_text({at, y.start + tick_length + font}, "middle", tick.label, out);
  }
  for (const Tick& tick : y.ticks) {
    const double at = y.at(tick.value);
    write_segment({x.start, at}, {x.start - (tick.label.empty() ? minor_length : tick_length), at}, ink, out);
    if (!tick.label.empty()) write_text({x.start - tick_length - 3, at + 0.36 * font}, "end", tick.label, out);
  }
  add(out,
      "<rect class=\"frame\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"none\" "
      "stroke=\"{}\"/>\n",
      x.start, y.end, size.x(), size.y(), ink);
  write_text({0.5 * (x.start + x.end), page_height - gap}, "middle", chart.x.label, out);
  add(out, "<text transform=\"translate({:.2f} {:.2f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      gap + 0.8 * font, 0.5 * (y.start + y.end), escaped(chart.y.label));
  out += "</g>\n";
}

void write_curves(const Chart& chart, const Ruler& x, const Ruler& y, std::string& out) {
  // a picture in the picture cuts the lines at the frame without a name that another picture of a page could have too
  add(out,
      "<svg x=\"{0:.2f}\" y=\"{1:.2f}\" width=\"{2:.2f}\" height=\"{3:.2f}\" viewBox=\"{0:.2f} {1:.2f} {2:.2f} "
      "{3:.2f}\">\n",
      x.start, y.end, x.end - x.start, y.start - y.end);
  std::string marks;
  for (const Curve& curve : chart.curves) {
    std::vector<Vec2> points;
    points.reserve(curve.points.size());
    for (const Vec2& point : curve.points) points.emplace_back(x.at(point.x()), y.at(point.y()));
    write_line(curve, points, out);
    add(marks, "<g fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.7\">\n", colour(curve.colour));
    for (const Vec2& point : points) {
      constexpr double rounding = 0.01; // px
      const bool inside = point.x() > x.start - rounding && point.x() < x.end + rounding &&
                          point.y() > y.end - rounding && point.y() < y.start + rounding;
      if (inside) write_mark(curve.mark, point, marks);
    }
    marks += "</g>\n";
  }
  out += "</svg>\n" + marks; // marks on the frame stay whole
}

void write_legend(const Chart& chart, double left, double top, std::string& out) {
  out += "<g class=\"legend\" font-size=\"" + fmt::format("{:g}", font) + "\">\n";
  double y = top + 0.5 * font;
  for (const Curve& curve : chart.curves) {
    if (curve.name.empty()) continue;
    write_line(curve, {{left, y}, {left + swatch, y}}, out);
    add(out, "<g fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.7\">\n", colour(curve.colour));
    write_mark(curve.mark, {left + 0.5 * swatch, y}, out);
    out += "</g>\n";
    write_text({left + swatch + 0.8 * gap, y + 0.36 * font}, "start", curve.name, out);
    y += 1.5 * font;
  }
  out += "</g>\n";
}

} // namespace

void write_chart(const Chart& chart, const std::filesystem::path& file) {
  Ruler x = ruler_of(chart, chart.x, 0), y = ruler_of(chart, chart.y, 1);
  double label = 0, legend = 0;
  for (const Tick& tick : y.ticks) label = std::max(label, width_of(tick.label));
  for (const Curve& curve : chart.curves) {
    if (!curve.name.empty()) legend = std::max(legend, swatch + 2.3 * gap + width_of(curve.name));
  }
  x.start = 2 * gap + font + label + tick_length;
  x.end = page_width - std::max(2.5 * gap, legend + gap);
  y.start = page_height - 2 * gap - 2 * font - tick_length;
  y.end = chart.title.empty() ? 1.5 * gap : 2 * gap + title_font;
  if (x.end - x.start < 0.25 * page_width) refuse(chart, "its names leave no room for the curves");

  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  add(out,
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" "
      "font-family=\"sans-serif\" fill=\"{2}\" stroke-linejoin=\"round\" "
      "style=\"max-width:100%\">\n<title>{3}</title>\n"
      "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n",
      page_width, page_height, ink, escaped(chart.title));
  add(out, "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:g}\" font-weight=\"bold\">{}</text>\n", x.start,
      gap + 0.8 * title_font, title_font, escaped(chart.title));
  write_axes(chart, x, y, out);
  write_curves(chart, x, y, out);
  write_legend(chart, x.end + 1.5 * gap, y.end, out);
  out += "</svg>\n";
  files::write_file(file, out);
}

} // namespace pneuma::pipeline::drawing
