// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <dxflib/dl_creationadapter.h>
#include <dxflib/dl_dxf.h>

#include "geometry/base/types.h"

namespace pneuma::tests {

// What dxflib, an independent reader, finds in a file; mm.
class DxfContents : private DL_CreationAdapter {
public:
  struct Line {
    std::string layer;
    bool closed;
    std::vector<base::Vec2> points;
  };
  struct Text {
    std::string layer, text;
    base::Vec2 at;
    double height, angle; // rad
  };
  std::map<std::string, int> layers; // -> colour
  std::vector<Line> lines;
  std::vector<Text> texts;
  std::map<std::string, base::Vec2> vectors; // of the header
  std::map<std::string, int> integers;
  std::map<std::string, std::string> strings;

  explicit DxfContents(const std::filesystem::path& file) {
    DL_Dxf reader;
    if (!reader.in(file.string(), this)) throw std::runtime_error("dxflib cannot read " + file.string());
  }

private:
  void addLayer(const DL_LayerData& layer) override { layers[layer.name] = getAttributes().getColor(); }
  void addLine(const DL_LineData& line) override {
    lines.push_back({getAttributes().getLayer(), false, {{line.x1, line.y1}, {line.x2, line.y2}}});
  }
  void addPolyline(const DL_PolylineData& line) override {
    lines.push_back({getAttributes().getLayer(), (line.flags & 1) == 1, {}});
  }
  void addVertex(const DL_VertexData& vertex) override { lines.back().points.emplace_back(vertex.x, vertex.y); }
  void addText(const DL_TextData& text) override {
    texts.push_back({getAttributes().getLayer(), text.text, {text.ipx, text.ipy}, text.height, text.angle});
  }
  void setVariableVector(const std::string& key, double x, double y, double /*z*/, int /*code*/) override {
    vectors[key] = {x, y};
  }
  void setVariableInt(const std::string& key, int value, int /*code*/) override { integers[key] = value; }
  void setVariableString(const std::string& key, const std::string& value, int /*code*/) override {
    strings[key] = value;
  }
  using DL_CreationAdapter::setVariableInt;
  using DL_CreationAdapter::setVariableString;
  using DL_CreationAdapter::setVariableVector;
};

} // namespace pneuma::tests
