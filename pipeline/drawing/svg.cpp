// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "pipeline/drawing/drawing.h"
#include "pipeline/drawing/xml.h"
#include "pipeline/files/file.h"

namespace pneuma::pipeline::drawing {

namespace {

constexpr double mm = 1e3;

// The AutoCAD colours 1 to 8 (red, yellow, green, cyan, blue, magenta, black on white, grey), dark enough for white.
const char* colour(int index) {
  static const std::map<int, const char*> colours = {{1, "#d00000"}, {2, "#a07000"}, {3, "#008030"}, {4, "#007890"},
                                                     {5, "#0040c0"}, {6, "#b000a0"}, {8, "#707070"}};
  const auto found = colours.find(index);
  return found == colours.end() ? "#000000" : found->second;
}

// Microns; y of SVG points down.
std::string pair(const Vec2& m, char separator) {
  return fmt::format("{:.3f}{}{:.3f}", mm * m.x() + 0.0, separator, -mm * m.y() + 0.0);
}

void write_line(const Polyline& line, std::string& out) {
  out += line.closed ? "<polygon points=\"" : "<polyline points=\"";
  for (const Vec2& point : line.points) out += pair(point, ',') + ' ';
  if (!line.points.empty()) out.pop_back();
  out += "\"/>\n";
}

void write_text(const Text& text, std::string& out) {
  fmt::format_to(
      std::back_inserter(out), R"xml(<text font-size="{:.2f}" transform="translate({}) rotate({:.3f})">{}</text>)xml",
      mm * text.height / capital_height, pair(text.at, ' '), -text.angle * 180 / std::numbers::pi, escaped(text.text));
  out += '\n';
}

void write_layer(const Drawing& drawing, const Layer& layer, std::string& out) {
  fmt::format_to(std::back_inserter(out), "<g id=\"{}\" stroke=\"{}\">\n", escaped(layer.name), colour(layer.colour));
  for (const Polyline& line : drawing.lines) {
    if (line.layer == layer.name) write_line(line, out);
  }
  fmt::format_to(std::back_inserter(out), "<g fill=\"{}\" stroke=\"none\">\n", colour(layer.colour));
  for (const Text& text : drawing.texts) {
    if (text.layer == layer.name) write_text(text, out);
  }
  out += "</g>\n</g>\n";
}

} // namespace

void write_svg(const Drawing& drawing, const std::filesystem::path& file) {
  const Extent all = extent(drawing);
  const Vec2 size = mm * (all.high - all.low);
  const double margin = 0.01 * size.maxCoeff() + 1;
  const Vec2 page = size.array() + 2 * margin;
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  // true to scale where it is printed, fitted to the window where it is looked at; lines keep their
  // width on the screen, or get one that suits the whole page where the reader cannot do that
  fmt::format_to(std::back_inserter(out),
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" "
                 "viewBox=\"{2:.3f} {3:.3f} {0:.3f} {1:.3f}\" style=\"max-width:100%;max-height:100%\">\n"
                 "<title>{4}</title>\n"
                 "<style>@supports (vector-effect: non-scaling-stroke) {{polygon, polyline {{vector-effect: "
                 "non-scaling-stroke; stroke-width: 1.2px}}}}</style>\n"
                 "<rect x=\"{2:.3f}\" y=\"{3:.3f}\" width=\"{0:.3f}\" height=\"{1:.3f}\" fill=\"#ffffff\"/>\n"
                 "<g fill=\"none\" stroke-width=\"{5:.2f}\" stroke-linejoin=\"round\" font-family=\"sans-serif\">\n",
                 page.x(), page.y(), mm * all.low.x() - margin, -mm * all.high.y() - margin, escaped(drawing.title),
                 page.maxCoeff() / 3000);
  for (const Layer& layer : drawing.layers) write_layer(drawing, layer, out);
  out += "</g>\n</svg>\n";
  files::write_file(file, out);
}

} // namespace pneuma::pipeline::drawing
