// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/pattern/fabrication.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/drawing/drawing.h"
#include "stages/pattern/strip_drawing.h"

namespace pneuma::stages::pattern {

namespace {

using base::Vec2;
using geometry::fabrication::Allowances;
using geometry::fabrication::CutStrip;
using geometry::fabrication::FlatStrip;
using geometry::fabrication::Placement;
using geometry::fabrication::Side;

constexpr double mm = 1e3;
constexpr double notch_without_allowance = 0.005; // m

SeamFigures& seam_called(const std::string& name, std::vector<SeamFigures>& seams) {
  const auto found = std::find_if(seams.begin(), seams.end(), [&](const SeamFigures& s) { return s.name == name; });
  if (found != seams.end()) return *found;
  seams.push_back({name, "", "", 0, 0});
  return seams.back();
}

std::vector<SeamFigures> seams_of(std::span<const StripSheet> strips) {
  std::vector<SeamFigures> seams;
  for (const StripSheet& strip : strips) {
    for (const Side& side : strip.flat.sides) {
      if (!side.seam) continue;
      SeamFigures& seam = seam_called(side.name, seams);
      // counterclockwise: a strip lies at the left of its sides
      (side.reversed ? seam.right : seam.left) = strip.flat.name;
      (side.reversed ? seam.length_right : seam.length_left) = length(side);
    }
  }
  for (const SeamFigures& seam : seams) {
    if (seam.left.empty() || seam.right.empty()) throw std::logic_error("seam " + seam.name + " joins no two strips");
  }
  return seams;
}

std::vector<FlatStrip> with_mates(std::span<const StripSheet> strips, std::vector<SeamFigures>& seams) {
  std::vector<FlatStrip> flats;
  for (const StripSheet& strip : strips) {
    flats.push_back(strip.flat);
    for (Side& side : flats.back().sides) {
      if (!side.seam) continue;
      const SeamFigures& seam = seam_called(side.name, seams);
      side.mate = side.reversed ? seam.left : seam.right;
      side.mate_length = side.reversed ? seam.length_left : seam.length_right;
    }
  }
  return flats;
}

StripFigures figures_of(const FlatStrip& flat, const CutStrip& cut, double distortion_max) {
  Vec2 low = cut.net.front();
  Vec2 high = low;
  for (const Vec2& point : cut.net) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  StripFigures figures;
  figures.name = flat.name;
  figures.width = high.y() - low.y();
  figures.length = high.x() - low.x();
  figures.cut_width = cut.high.y() - cut.low.y();
  figures.cut_length = cut.high.x() - cut.low.x();
  figures.net_area = cut.net_area;
  figures.cut_area = cut.area;
  figures.distortion_max = distortion_max;
  for (const Side& side : flat.sides) {
    if (side.seam) {
      figures.seam_mismatch_max = std::max(figures.seam_mismatch_max, std::abs(length(side) - side.mate_length));
    }
  }
  return figures;
}

// A field of a CSV file (RFC 4180).
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string strips_table(const std::vector<FlatStrip>& flats, const Fabrication& result) {
  std::string table = "name,width_mm,length_mm,cut_width_mm,cut_length_mm,net_area_m2,cut_area_m2,distortion_max,seams,"
                      "seam_lengths_mm,seam_mismatch_mm\n";
  for (std::size_t i = 0; i < flats.size(); ++i) {
    const StripFigures& strip = result.strips[i];
    std::vector<std::string> names;
    std::vector<std::string> lengths;
    std::vector<std::string> mismatches; // own length less that of the mate
    for (const Side& side : flats[i].sides) {
      if (!side.seam) continue;
      names.push_back(side.name);
      lengths.push_back(fmt::format("{:.2f}", mm * length(side)));
      mismatches.push_back(fmt::format("{:.3f}", mm * (length(side) - side.mate_length)));
    }
    table +=
        fmt::format("{},{:.2f},{:.2f},{:.2f},{:.2f},{:.6f},{:.6f},{:.6f},{},{},{}\n", field(strip.name),
                    mm * strip.width, mm * strip.length, mm * strip.cut_width, mm * strip.cut_length, strip.net_area,
                    strip.cut_area, strip.distortion_max, field(fmt::format("{}", fmt::join(names, ";"))),
                    fmt::join(lengths, ";"), fmt::join(mismatches, ";"));
  }
  return table;
}

std::string seams_table(const std::vector<SeamFigures>& seams) {
  std::string table = "name,left,right,length_left_mm,length_right_mm,mismatch_mm,mismatch_mm_per_m\n";
  for (const SeamFigures& seam : seams) {
    table += fmt::format("{},{},{},{:.2f},{:.2f},{:.3f},{:.4f}\n", field(seam.name), field(seam.left),
                         field(seam.right), mm * seam.length_left, mm * seam.length_right, mm * seam.mismatch(),
                         mm * seam.mismatch() / seam.length());
  }
  return table;
}

void add_sums(Fabrication& result) {
  for (const StripFigures& strip : result.strips) {
    result.net_area += strip.net_area;
    result.cut_area += strip.cut_area;
  }
  for (const SeamFigures& seam : result.seams) {
    result.weld_length += seam.length();
    result.seam_mismatch_max = std::max(result.seam_mismatch_max, std::abs(seam.mismatch()));
    result.mismatch_per_length_max =
        std::max(result.mismatch_per_length_max, std::abs(seam.mismatch()) / seam.length());
  }
}

} // namespace

Fabrication fabricate(const std::string& foil, std::span<const StripSheet> strips, const Allowances& allowances,
                      const RollSheet& roll) {
  Fabrication result;
  result.seams = seams_of(strips);
  const std::vector<FlatStrip> flats = with_mates(strips, result.seams);
  std::vector<CutStrip> cuts;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < flats.size(); ++i) {
    cuts.push_back(cut_strip(flats[i], allowances));
    names.push_back(flats[i].name);
    result.strips.push_back(figures_of(flats[i], cuts[i], strips[i].distortion_max));
  }
  add_sums(result);
  result.roll_width = roll.may_widen ? std::max(roll.width, roll_width_for(cuts, roll.selvedge)) : roll.width;
  result.nesting = nest(cuts, names, result.roll_width, roll.selvedge, roll.gap);

  pipeline::drawing::Drawing& drawing = result.drawing;
  drawing = {foil, strip_layers(), {}, {}};
  draw_roll(result.nesting.length, result.roll_width, roll.selvedge, drawing);
  const double notch_length = allowances.seam > 0 ? allowances.seam : notch_without_allowance;
  for (const Placement& placement : result.nesting.placements) {
    const auto i = static_cast<std::size_t>(placement.strip);
    draw_strip(flats[i], cuts[i], placement, notch_length, drawing);
  }
  result.strips_table = strips_table(flats, result);
  result.seams_table = seams_table(result.seams);
  return result;
}

void write_sheets(const std::string& foil, const Fabrication& made, pipeline::files::Outputs& outputs) {
  write_dxf(made.drawing, outputs.file(foil + ".dxf"));
  write_svg(made.drawing, outputs.file(foil + ".svg"));
  pipeline::files::write_file(outputs.file(foil + "_strips.csv"), made.strips_table);
  pipeline::files::write_file(outputs.file(foil + "_seams.csv"), made.seams_table);
}

} // namespace pneuma::stages::pattern
