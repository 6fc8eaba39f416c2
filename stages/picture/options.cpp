// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/options.h"

#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/types.h"
#include "stages/common/command_line.h"

namespace pneuma::stages::picture {

namespace {

using base::InputError;
using common::Words;
using pipeline::schema::suggestion;

template <class Number>
Number number(const std::string& option, const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw InputError(
        fmt::format("{}: '{}' is not a {}", option, text, std::is_integral_v<Number> ? "whole number" : "number"));
  }
  if (!std::isfinite(static_cast<double>(value))) throw InputError(fmt::format("{}: must be finite", option));
  return value;
}

void set_size(Options& options, const std::string& text) {
  constexpr int least = 64;
  constexpr int most = 8192; // software rendering has a limit of 16384
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) throw InputError(fmt::format("--size: '{}' is not WxH, e.g. 1400x900", text));
  options.width = number<int>("--size", text.substr(0, cross));
  options.height = number<int>("--size", text.substr(cross + 1));
  for (const int size : {options.width, options.height}) {
    if (size < least || size > most) {
      throw InputError(fmt::format("--size: {} pixels are not within {} .. {}", size, least, most));
    }
  }
}

void set_component(Options& options, const std::string& text) {
  if (text == "magnitude") return options.component.reset();
  options.component = number<int>("--component", text);
}

void set_range(Options& options, const std::string& low, const std::string& high) {
  options.range = {number<double>("--range", low), number<double>("--range", high)};
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
  throw InputError(
      fmt::format("--view: '{}' is none of {}{}", text, pipeline::schema::joined(names), suggestion(text, names)));
}

const std::vector<common::Switch<Options>>& switches() {
  static const std::vector<common::Switch<Options>> all = {
      {"--field", 1, [](Options& o, const Words& v) { o.field = v[0]; }},
      {"--out", 1, [](Options& o, const Words& v) { o.out = v[0]; }},
      {"--size", 1, [](Options& o, const Words& v) { set_size(o, v[0]); }},
      {"--title", 1, [](Options& o, const Words& v) { o.title = v[0]; }},
      {"--component", 1, [](Options& o, const Words& v) { set_component(o, v[0]); }},
      {"--range", 2, [](Options& o, const Words& v) { set_range(o, v[0], v[1]); }},
      {"--explode", 1, [](Options& o, const Words& v) { o.explode = number<double>("--explode", v[0]); }},
      {"--view", 1, [](Options& o, const Words& v) { set_view(o, v[0]); }},
      {"--warp", 1, [](Options& o, const Words& v) { o.warp = number<double>("--warp", v[0]); }},
  };
  return all;
}

} // namespace

const char* usage() {
  return "usage: pneuma-picture STATE.hdf --field NAME|none --out PICTURE.png\n"
         "  --size WxH           pixels [1400x900]\n"
         "  --title TEXT         above the picture [none]\n"
         "  --component N        component of a field that has several, from 0 [magnitude]\n"
         "  --range A B          ends of the colour scale in the field's stored unit (SI: Pa, not MPa) [smallest and "
         "largest value]\n"
         "  --explode METRES     draw neighbouring foils this much further apart [0]\n"
         "  --view iso|top|side  [iso]\n"
         "  --warp FACTOR        draw displacements this many times as large [1]";
}

Options parse(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  Options options;
  common::read_command_line(words, switches(), usage(), options, [&](const std::string& word) {
    if (!options.state.empty()) {
      throw InputError(fmt::format("two states: {} and {}", options.state.string(), word));
    }
    options.state = word;
  });
  if (options.state.empty()) throw InputError(fmt::format("no state is given\n{}", usage()));
  if (options.field.empty()) throw InputError(fmt::format("--field is missing\n{}", usage()));
  if (options.out.extension() != ".png") throw InputError(fmt::format("--out must name a .png file\n{}", usage()));
  return options;
}

} // namespace pneuma::stages::picture
