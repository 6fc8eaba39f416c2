// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/options.h"

#include <vector>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/types.h"
#include "pipeline/command_line/command_line.h"
#include "pipeline/schema/quantity.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::stages::picture {

namespace {

using base::InputError;
using pipeline::command_line::Command;
using pipeline::command_line::Times;
using pipeline::command_line::whole_number;
using pipeline::command_line::Words;

double number(const std::string& option, const std::string& text) {
  const std::optional<double> value = pipeline::schema::parse_number(text);
  if (!value) throw InputError(fmt::format("{}: `{}` is not a number", option, text));
  return *value;
}

void set_size(Options& options, const std::string& text) {
  constexpr int least = 64;
  constexpr int most = 8192; // software rendering has a limit of 16384
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) throw InputError(fmt::format("--size: `{}` is not WxH, e.g. 1400x900", text));
  options.width = whole_number("--size", text.substr(0, cross), least, most);
  options.height = whole_number("--size", text.substr(cross + 1), least, most);
}

void set_component(Options& options, const std::string& text) {
  if (text == "magnitude") return options.component.reset();
  options.component = whole_number("--component", text, 0);
}

void set_range(Options& options, const std::string& low, const std::string& high) {
  options.range = {number("--range", low), number("--range", high)};
  if (options.range->first >= options.range->second) {
    throw InputError(fmt::format("--range: {} is not below {}", low, high));
  }
}

void set_view(Options& options, const std::string& text) {
  const std::vector<std::string> names = {"iso", "top", "side"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (text == names[i]) {
      options.view = static_cast<View>(i);
      return;
    }
  }
  throw InputError(fmt::format("--view: `{}` is none of {}{}", text, pipeline::schema::joined(names),
                               pipeline::schema::suggestion(text, names)));
}

Command program(Options& o) {
  return {"pneuma-picture",
          "draws a state as a PNG, without a screen",
          {{"STATE.hdf", "", "the state", [&](const Words& v) { o.state = v[0]; }, Times::once},
           {"--field", "NAME|none", "field that gives the colours; none: the mesh alone",
            [&](const Words& v) { o.field = v[0]; }, Times::once},
           {"--out", "PICTURE.png", "file to be written", [&](const Words& v) { o.out = v[0]; }, Times::once},
           {"--size", "WxH", "pixels [1400x900]", [&](const Words& v) { set_size(o, v[0]); }},
           {"--title", "TEXT", "above the picture [none]", [&](const Words& v) { o.title = v[0]; }},
           {"--component", "N", "component of a field that has several, from 0 [magnitude]",
            [&](const Words& v) { set_component(o, v[0]); }},
           {"--range", "A B",
            "ends of the colour scale in the field's stored unit (SI: Pa, not MPa) [smallest and largest value]",
            [&](const Words& v) { set_range(o, v[0], v[1]); }},
           {"--explode", "METRES", "draw neighbouring foils this much further apart [0]",
            [&](const Words& v) { o.explode = number("--explode", v[0]); }},
           {"--view", "iso|top|side", "from where [iso]", [&](const Words& v) { set_view(o, v[0]); }},
           {"--warp", "FACTOR", "draw displacements this many times as large [1]",
            [&](const Words& v) { o.warp = number("--warp", v[0]); }}},
          {},
          [&] {
            if (o.out.extension() != ".png") throw InputError("--out must name a .png file");
          }};
}

} // namespace

std::optional<Options> parse(int argc, char** argv) {
  Options options;
  if (!pipeline::command_line::read(program(options), Words(argv + 1, argv + argc))) return std::nullopt;
  return options;
}

} // namespace pneuma::stages::picture
