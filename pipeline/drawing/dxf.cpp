// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

#include "pipeline/drawing/drawing.h"
#include "pipeline/files/file.h"

namespace pneuma::pipeline::drawing {

namespace {

constexpr double mm = 1e3;

// R12: 31 letters at most
std::string layer_name(const std::string& name) {
  std::string result = name.substr(0, 31);
  for (char& c : result) {
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const bool allowed = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '$' || c == '_' || c == '-';
    if (!allowed) c = '_';
  }
  return result;
}

std::string ascii(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '_');
  return text;
}

// Pairs of a group code and its value, a line each (AutoCAD R12 reference, appendix "Drawing interchange files").
class Writer {
public:
  void text(int code, std::string_view value) { fmt::format_to(std::back_inserter(bytes_), "{}\n{}\n", code, value); }
  void number(int code, int value) { fmt::format_to(std::back_inserter(bytes_), "{}\n{}\n", code, value); }
  void real(int code, double value) {
    const double shown = std::abs(value) < 5e-10 ? 0 : value; // no -0
    fmt::format_to(std::back_inserter(bytes_), "{}\n{:.9f}\n", code, shown);
  }
  // the codes of x, y and z differ by ten
  void point(int code, const Vec2& m) {
    real(code, mm * m.x());
    real(code + 10, mm * m.y());
    real(code + 20, 0);
  }
  const std::string& bytes() const { return bytes_; }

private:
  std::string bytes_;
};

void write_header(const Drawing& drawing, Writer& out) {
  const Extent all = extent(drawing);
  out.text(0, "SECTION");
  out.text(2, "HEADER");
  out.text(9, "$ACADVER");
  out.text(1, "AC1009");
  out.text(9, "$INSUNITS");
  out.number(70, 4); // mm
  out.text(9, "$EXTMIN");
  out.point(10, all.low);
  out.text(9, "$EXTMAX");
  out.point(10, all.high);
  out.text(0, "ENDSEC");
}

void begin_table(const char* name, std::size_t entries, Writer& out) {
  out.text(0, "TABLE");
  out.text(2, name);
  out.number(70, static_cast<int>(entries));
}

void write_layer(const std::string& name, int colour, Writer& out) {
  out.text(0, "LAYER");
  out.text(2, name);
  out.number(70, 0);
  out.number(62, colour);
  out.text(6, "CONTINUOUS");
}

void write_tables(const Drawing& drawing, Writer& out) {
  out.text(0, "SECTION");
  out.text(2, "TABLES");
  begin_table("LTYPE", 1, out);
  out.text(0, "LTYPE");
  out.text(2, "CONTINUOUS");
  out.number(70, 0);
  out.text(3, "Solid line");
  out.number(72, 65); // always
  out.number(73, 0);
  out.real(40, 0);
  out.text(0, "ENDTAB");
  begin_table("LAYER", drawing.layers.size() + 1, out);
  write_layer("0", 7, out); // must exist
  for (const Layer& layer : drawing.layers) write_layer(layer_name(layer.name), layer.colour, out);
  out.text(0, "ENDTAB");
  begin_table("STYLE", 1, out);
  out.text(0, "STYLE");
  out.text(2, "STANDARD");
  out.number(70, 0);
  out.real(40, 0); // height: each text its own
  out.real(41, letter_width);
  out.real(50, 0);
  out.number(71, 0);
  out.real(42, 1);
  out.text(3, "txt");
  out.text(4, "");
  out.text(0, "ENDTAB");
  out.text(0, "ENDSEC");
}

void write_line(const Polyline& line, Writer& out) {
  out.text(0, "LINE");
  out.text(8, layer_name(line.layer));
  out.point(10, line.points[0]);
  out.point(11, line.points[1]);
}

void write_polyline(const Polyline& line, Writer& out) {
  const std::string layer = layer_name(line.layer);
  out.text(0, "POLYLINE");
  out.text(8, layer);
  out.number(66, 1); // vertices follow
  out.point(10, Vec2::Zero());
  out.number(70, line.closed ? 1 : 0);
  for (const Vec2& point : line.points) {
    out.text(0, "VERTEX");
    out.text(8, layer);
    out.point(10, point);
  }
  out.text(0, "SEQEND");
  out.text(8, layer);
}

void write_text(const Text& text, Writer& out) {
  out.text(0, "TEXT");
  out.text(8, layer_name(text.layer));
  out.point(10, text.at);
  out.real(40, mm * text.height);
  out.text(1, ascii(text.text));
  out.real(50, text.angle * 180 / std::numbers::pi);
  out.real(41, letter_width);
  out.text(7, "STANDARD");
}

} // namespace

void write_dxf(const Drawing& drawing, const std::filesystem::path& file) {
  Writer out;
  out.text(999, ascii(drawing.title));
  write_header(drawing, out);
  write_tables(drawing, out);
  out.text(0, "SECTION");
  out.text(2, "ENTITIES");
  for (const Polyline& line : drawing.lines) {
    if (line.points.size() == 2) {
      write_line(line, out);
    } else {
      write_polyline(line, out);
    }
  }
  for (const Text& text : drawing.texts) write_text(text, out);
  out.text(0, "ENDSEC");
  out.text(0, "EOF");
  files::write_file(file, out.bytes());
}

} // namespace pneuma::pipeline::drawing
