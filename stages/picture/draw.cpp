// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/draw.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkAutoInit.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkLightKit.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include "geometry/base/errors.h"
#include "pipeline/files/file.h"
#include "pipeline/schema/spelling.h"
#include "stages/picture/offscreen.h"
#include "stages/picture/surface.h"

// What draws for VTK's interfaces; CMake's vtk_module_autoinit does it by an absolute path in every command line, which
// the compiler's cache of another clone does not know.
VTK_MODULE_INIT(vtkRenderingFreeType)
VTK_MODULE_INIT(vtkRenderingOpenGL2)

namespace pneuma::stages::picture {

namespace {

using base::InputError;
using pipeline::state::Field;
using pipeline::state::Location;
using pipeline::state::State;

// --- what is shown ---

// One number a node or an element, and how its colour scale reads.
struct Shown {
  Location location = Location::point;
  std::vector<double> values; // empty: the mesh alone
  bool per_block = false;     // values at the nodes for each block in turn
  std::string title;
  double low = 0, high = 1;         // ends of the colour scale
  double smallest = 0, largest = 0; // finite values
};

struct ScaledUnit {
  const char* unit;
  double from; // used for values from here
  double factor;
  const char* shown;
};
constexpr ScaledUnit scaled_units[] = {{"Pa", 1e5, 1e6, "MPa"}, {"Pa", 1e2, 1e3, "kPa"}, {"N/m", 1e2, 1e3, "kN/m"},
                                       {"m", 1e-1, 1, "m"},     {"m", 1e-4, 1e-3, "mm"}, {"m", 0, 1e-6, "\u00b5m"}};

// The field of that name; or, where the foils have one each at their nodes (`name.foil`: on the rim they differ), all
// of them one after the other, NaN for a block without.
struct Found {
  Field field;
  bool per_block = false; // values [block][node][component]
};

Found field_called(const State& state, const std::string& name) {
  std::vector<std::string> names;
  for (const Location location : {Location::point, Location::cell}) {
    for (const Field& field : state.fields) {
      if (field.location != location) continue;
      if (field.name == name) return {field, false};
      names.push_back(field.name);
    }
  }
  Found found;
  found.per_block = true;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const auto of_block = [&](const geometry::Block& block) {
    return std::find_if(state.fields.begin(), state.fields.end(), [&](const Field& field) {
      return field.location == Location::point && field.name == name + "." + block.name;
    });
  };
  for (const geometry::Block& block : state.mesh.blocks) {
    const auto field = of_block(block);
    if (field == state.fields.end()) continue;
    found.field.name = name;
    found.field.unit = field->unit;
    found.field.components = field->components;
  }
  if (!found.field.name.empty()) {
    const std::size_t size = state.mesh.nodes.size() * static_cast<std::size_t>(found.field.components);
    for (const geometry::Block& block : state.mesh.blocks) {
      const auto field = of_block(block);
      const std::vector<double> values =
          field == state.fields.end() ? std::vector<double>(size, nothing) : field->values;
      found.field.values.insert(found.field.values.end(), values.begin(), values.end());
    }
    return found;
  }
  for (const geometry::Block& block : state.mesh.blocks) {
    const std::string ending = "." + block.name;
    for (std::size_t i = 0, count = names.size(); i < count; ++i) {
      const std::size_t length = names[i].size();
      if (length <= ending.size() || names[i].compare(length - ending.size(), ending.size(), ending) != 0) continue;
      const std::string family = names[i].substr(0, length - ending.size());
      if (std::find(names.begin(), names.end(), family) == names.end()) names.push_back(family);
    }
  }
  names.emplace_back("none");
  throw InputError(fmt::format("--field: the state has no point or cell field '{}'{}; it has: {}", name,
                               pipeline::schema::suggestion(name, names), pipeline::schema::joined(names)));
}

std::vector<double> one_number_each(const Field& field, std::optional<int> component) {
  if (component && (*component < 0 || *component >= field.components)) {
    throw InputError(
        fmt::format("--component: {} has components 0 .. {}, not {}", field.name, field.components - 1, *component));
  }
  const auto n = static_cast<std::size_t>(field.components);
  std::vector<double> values(field.values.size() / n);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double* row = field.values.data() + i * n;
    if (component) {
      values[i] = row[*component];
    } else if (n == 1) {
      values[i] = row[0];
    } else {
      double squares = 0;
      for (std::size_t k = 0; k < n; ++k) squares += row[k] * row[k];
      values[i] = std::sqrt(squares);
    }
  }
  return values;
}

// Ends of the scale for values that differ by no more than rounding: a little around them.
void open_up(double& low, double& high) {
  const double size = std::max(std::abs(low), std::abs(high));
  if (high - low > 1e-6 * size) return;
  const double margin = size > 0 ? 0.05 * size : 1;
  low -= margin;
  high += margin;
}

Shown shown(const State& state, const Options& options) {
  if (options.field == "none") return {};
  const auto [field, per_block] = field_called(state, options.field);
  Shown what;
  what.per_block = per_block;
  what.location = field.location;
  what.values = one_number_each(field, options.component);
  std::string unit = field.unit == "1" ? "" : field.unit;
  double size = 0;
  for (const double value : what.values) size = std::max(size, std::isfinite(value) ? std::abs(value) : 0);
  double factor = 1;
  for (const ScaledUnit& scaled : scaled_units) {
    if (field.unit != scaled.unit || size < scaled.from) continue;
    factor = scaled.factor;
    unit = scaled.shown;
    break;
  }
  what.smallest = std::numeric_limits<double>::infinity();
  what.largest = -what.smallest;
  for (double& value : what.values) {
    value /= factor;
    if (!std::isfinite(value)) continue;
    what.smallest = std::min(what.smallest, value);
    what.largest = std::max(what.largest, value);
  }
  if (what.smallest > what.largest) what.smallest = what.largest = 0;
  what.low = options.range ? options.range->first / factor : what.smallest;
  what.high = options.range ? options.range->second / factor : what.largest;
  open_up(what.low, what.high);
  what.title = field.name;
  std::replace(what.title.begin(), what.title.end(), '_', ' ');
  if (options.component && field.components > 1) {
    const bool vector = field.components == 3;
    what.title += vector ? fmt::format(" {}", "xyz"[*options.component]) : fmt::format(" {}", *options.component);
  }
  if (!unit.empty()) what.title += fmt::format("\n[{}]", unit);
  return what;
}

// Where the nodes are drawn, before the foils are drawn apart.
std::vector<Vec3> drawn_positions(const State& state, double warp) {
  std::vector<Vec3> positions = state.mesh.nodes;
  if (warp == 1) return positions;
  for (const Field& field : state.fields) {
    if (field.name != "displacement" || field.location != Location::point || field.components != 3) continue;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] += (warp - 1) * Eigen::Map<const Vec3>(field.values.data() + 3 * i);
    }
    return positions;
  }
  throw InputError("--warp needs the point field `displacement`, which the state does not have");
}

// Quadratic elements are divided more finely the fewer they are.
int divisions_for(const geometry::Mesh& mesh) {
  if (!geometry::is_quadratic(mesh.element)) return 1;
  constexpr double enough = 100'000; // parts in all
  double elements = 1;
  for (const geometry::Block& block : mesh.blocks) elements += mesh.element_count(block);
  return std::clamp(static_cast<int>(std::sqrt(enough / elements)), 2, 6);
}

std::vector<Surface> surfaces_of(const State& state, const Shown& what, const Options& options) {
  const geometry::Mesh& mesh = state.mesh;
  const std::vector<Vec3> positions = drawn_positions(state, options.warp);
  const int divisions = divisions_for(mesh);
  std::vector<Surface> surfaces;
  auto next = what.values.begin();
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    std::vector<Vec3> lifted = positions;
    for (Vec3& position : lifted) position.z() += options.explode * static_cast<double>(mesh.blocks.size() - 1 - b);
    std::vector<double> of_elements;
    if (!what.values.empty() && what.location == Location::cell) {
      const auto end = next + mesh.element_count(mesh.blocks[b]);
      of_elements.assign(next, end);
      next = end;
    }
    std::vector<double> at_nodes;
    if (what.location == Location::point && what.per_block) {
      const auto begin = what.values.begin() + static_cast<std::ptrdiff_t>(b * mesh.nodes.size());
      at_nodes.assign(begin, begin + static_cast<std::ptrdiff_t>(mesh.nodes.size()));
    } else if (what.location == Location::point) {
      at_nodes = what.values;
    }
    surfaces.push_back(
        surface_of(mesh, mesh.blocks[b], lifted, at_nodes, of_elements, state.foils[b].strip_of_element, divisions));
  }
  return surfaces;
}

// --- how it is seen ---

struct Eye {
  Vec3 direction; // from the scene to the eye
  Vec3 right, up; // of the picture
  Vec3 centre;
  double distance = 1; // m, outside the scene
  double pixels_per_metre = 1;
};

// Parallel projection that fills the part of the window which title and colour scale leave.
Eye eye_on(const std::vector<Surface>& surfaces, const Options& options, bool scale) {
  Eye eye;
  eye.direction = options.view == View::top    ? Vec3(0, 0, 1)
                  : options.view == View::side ? Vec3(0, -1, 0)
                                               : Vec3(-0.45, -1, 0.4).normalized();
  eye.right = options.view == View::top ? Vec3(1, 0, 0) : Vec3(0, 0, 1).cross(eye.direction).normalized();
  eye.up = eye.direction.cross(eye.right);
  Eigen::AlignedBox3d box;
  for (const Surface& surface : surfaces) {
    for (const Vec3& p : surface.points) box.extend(Vec3(p.dot(eye.right), p.dot(eye.up), p.dot(eye.direction)));
  }
  if (box.isEmpty()) throw base::StateError("there is nothing to draw: the state has no elements");
  const double left = 0.05;
  const double right = scale ? 0.82 : 0.95;
  const double bottom = 0.06;
  const double top = options.title.empty() ? 0.94 : 0.88;
  const Vec3 size = box.sizes();
  const double tiny = 1e-9 * (1e-300 + size.norm());
  eye.pixels_per_metre = std::min((right - left) * options.width / std::max(size.x(), tiny),
                                  (top - bottom) * options.height / std::max(size.y(), tiny));
  eye.distance = 2 * size.norm();
  const Vec3 middle = box.center();
  const double aside = ((left + right) / 2 - 0.5) * options.width / eye.pixels_per_metre;
  const double above = ((bottom + top) / 2 - 0.5) * options.height / eye.pixels_per_metre;
  eye.centre = (middle.x() - aside) * eye.right + (middle.y() - above) * eye.up + middle.z() * eye.direction;
  return eye;
}

// --- VTK ---

constexpr double ink[] = {0.13, 0.15, 0.19};

vtkNew<vtkColorTransferFunction> viridis(double low, double high) {
  // nine colours of the map by S. van der Walt and N. Smith (CC0)
  constexpr int colours[] = {0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725};
  vtkNew<vtkColorTransferFunction> map;
  map->SetColorSpaceToLab();
  for (int i = 0; i < 9; ++i) {
    const auto part = [&](int shift) { return ((colours[i] >> shift) & 0xff) / 255.0; };
    map->AddRGBPoint(low + (high - low) * i / 8, part(16), part(8), part(0));
  }
  map->SetNanColor(0.8, 0.8, 0.8);
  return map;
}

void add_foil(vtkRenderer* renderer, const Surface& surface, vtkColorTransferFunction* map, std::size_t number) {
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkNew<vtkFloatArray> normals;
  normals->SetNumberOfComponents(3);
  normals->SetName("Normals");
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    points->InsertNextPoint(surface.points[i].data());
    normals->InsertNextTuple(surface.normals[i].data());
  }
  const vtkNew<vtkCellArray> triangles;
  for (const auto& [a, b, c] : surface.triangles) triangles->InsertNextCell({a, b, c});
  const vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(triangles);
  data->GetPointData()->SetNormals(normals);
  const vtkNew<vtkPolyDataMapper> mapper;
  if (map != nullptr) {
    const vtkNew<vtkDoubleArray> values;
    for (const double value : surface.values) values->InsertNextValue(value);
    data->GetPointData()->SetScalars(values);
    mapper->SetLookupTable(map);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
  }
  mapper->SetInputData(data);
  const vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  constexpr double foils[3][3] = {{0.62, 0.76, 0.88}, {0.93, 0.79, 0.60}, {0.72, 0.84, 0.66}};
  actor->GetProperty()->SetColor(foils[number % 3][0], foils[number % 3][1], foils[number % 3][2]);
  actor->GetProperty()->SetAmbient(0.4);
  actor->GetProperty()->SetDiffuse(0.65);
  actor->GetProperty()->SetSpecular(0.08);
  actor->GetProperty()->SetSpecularPower(20);
  renderer->AddActor(actor);
}

// Drawn a little nearer to the eye, which a parallel projection does not show, so that the foil does not swallow them.
void add_lines(vtkRenderer* renderer, const std::vector<std::vector<Vec3>>& lines, const Vec3& nearer, double width,
               double opacity) {
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkNew<vtkCellArray> cells;
  for (const std::vector<Vec3>& line : lines) {
    cells->InsertNextCell(static_cast<int>(line.size()));
    for (const Vec3& point : line) cells->InsertCellPoint(points->InsertNextPoint(Vec3(point + nearer).data()));
  }
  const vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(cells);
  const vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  const vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(ink[0], ink[1], ink[2]);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  actor->GetProperty()->SetOpacity(opacity);
  actor
      ->ForceOpaqueOn(); // blends with the foil drawn before; VTK's pass for the translucent does not see what hides it
  renderer->AddActor(actor);
}

// Text whose anchor (VTK_TEXT_LEFT ..., VTK_TEXT_BOTTOM ...) is at (x, y), in pixels from the lower left corner.
void add_text(vtkRenderer* renderer, const std::string& words, double x, double y, double pixels, int across,
              int along) {
  const vtkNew<vtkTextActor> text;
  text->SetInput(words.c_str());
  vtkTextProperty* style = text->GetTextProperty();
  style->SetFontFamilyToArial();
  style->SetFontSize(static_cast<int>(std::lround(pixels)));
  style->SetColor(ink[0], ink[1], ink[2]);
  style->SetLineSpacing(1.15);
  style->SetJustification(across);
  style->SetVerticalJustification(along);
  text->SetPosition(x, y);
  renderer->AddActor2D(text);
}

// Round numbers within the scale, 1, 2 or 5 times a power of ten apart.
std::vector<double> round_numbers(double low, double high) {
  const double rough = (high - low) / 6;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double step = power * (rough / power < 1.5 ? 1 : rough / power < 3.5 ? 2 : rough / power < 7.5 ? 5 : 10);
  std::vector<double> numbers;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) numbers.push_back(k * step + 0.0);
  return numbers;
}

// Flat drawing in pixels, on top of everything.
void add_flat(vtkRenderer* renderer, vtkPolyData* data, vtkColorTransferFunction* map) {
  const vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(data);
  mapper->SetLookupTable(map);
  mapper->UseLookupTableScalarRangeOn();
  const vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(ink[0], ink[1], ink[2]);
  renderer->AddActor2D(actor);
}

// vtkScalarBarActor would be the ready-made thing, but it shifts its labels to stay within the bar.
void add_scale(vtkRenderer* renderer, const Shown& what, vtkColorTransferFunction* map, const Options& options) {
  const double letter = options.height / 48.0; // pixels, like all below
  const double left = 0.88 * options.width;
  const double right = left + 1.4 * letter;
  const double bottom = 0.22 * options.height;
  const double top = 0.76 * options.height;
  const auto height_of = [&](double value) {
    return bottom + (top - bottom) * (value - what.low) / (what.high - what.low);
  };

  constexpr int bands = 128;
  const vtkNew<vtkPoints> corners;
  const vtkNew<vtkCellArray> quads;
  const vtkNew<vtkDoubleArray> values;
  for (int i = 0; i <= bands; ++i) {
    const double value = what.low + (what.high - what.low) * i / bands;
    const vtkIdType a = corners->InsertNextPoint(left, height_of(value), 0);
    const vtkIdType b = corners->InsertNextPoint(right, height_of(value), 0);
    values->InsertNextValue(value);
    values->InsertNextValue(value);
    if (i < bands) quads->InsertNextCell({a, b, b + 2, a + 2});
  }
  const vtkNew<vtkPolyData> bar;
  bar->SetPoints(corners);
  bar->SetPolys(quads);
  bar->GetPointData()->SetScalars(values);
  add_flat(renderer, bar, map);

  const vtkNew<vtkPoints> ends;
  const vtkNew<vtkCellArray> ticks;
  for (const double number : round_numbers(what.low, what.high)) {
    const double y = height_of(number);
    const vtkIdType from = ends->InsertNextPoint(right, y, 0);
    const vtkIdType to = ends->InsertNextPoint(right + letter / 4, y, 0);
    ticks->InsertNextCell({from, to});
    add_text(renderer, fmt::format("{:.6g}", number), right + letter / 2, y, letter, VTK_TEXT_LEFT, VTK_TEXT_CENTERED);
  }
  const vtkNew<vtkPolyData> marks;
  marks->SetPoints(ends);
  marks->SetLines(ticks);
  add_flat(renderer, marks, map);

  const double middle = 0.915 * options.width;
  add_text(renderer, what.title, middle, top + letter, 1.1 * letter, VTK_TEXT_CENTERED, VTK_TEXT_BOTTOM);
  add_text(renderer, fmt::format("max {:.4g}\nmin {:.4g}", what.largest, what.smallest), middle, bottom - letter,
           letter, VTK_TEXT_CENTERED, VTK_TEXT_TOP);
}

// Mean length of the elements' edges in the picture; what is small gets faint lines.
double mean_edge_pixels(const std::vector<Surface>& surfaces, double pixels_per_metre) {
  double sum = 0;
  std::size_t count = 0;
  for (const Surface& surface : surfaces) {
    for (const std::vector<Vec3>& edge : surface.edges) sum += (edge.back() - edge.front()).norm();
    count += surface.edges.size();
  }
  return count > 0 ? pixels_per_metre * sum / static_cast<double>(count) : 0;
}

void set_up(vtkGenericOpenGLRenderWindow* window, int width, int height) {
  window->SetIsCurrent(true);
  window->SetMapped(true);
  window->SetReadyForRendering(true);
  window->SetSupportsOpenGL(true);
  window->SetOwnContext(0);
  window->SetMultiSamples(8);
  window->SetSize(width, height);
  window->OpenGLInitContext();
  window->SetFrameBlitModeToNoBlit();
}

void write_png(vtkRenderWindow* window, const std::filesystem::path& path) {
  const vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  image->ShouldRerenderOff();
  const vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  if (bytes == nullptr)
    throw base::MachineError(fmt::format("{}: the picture cannot be made: no memory", path.string()));
  pipeline::files::write_file(path, {reinterpret_cast<const char*>(bytes->GetPointer(0)),
                                     static_cast<std::size_t>(bytes->GetNumberOfValues())});
}

} // namespace

void draw(const State& state, const Options& options) {
  const Shown what = shown(state, options);
  const bool has_scale = !what.values.empty();
  const std::vector<Surface> surfaces = surfaces_of(state, what, options);
  const Eye eye = eye_on(surfaces, options, has_scale);

  const OffscreenContext context;
  // VTK complains that there is no X server; what matters is checked
  vtkObject::GlobalWarningDisplayOff();
  const vtkNew<vtkGenericOpenGLRenderWindow> window;
  set_up(window, options.width, options.height);
  const vtkNew<vtkRenderer> renderer;
  window->AddRenderer(renderer);
  renderer->SetBackground(1, 1, 1);
  const vtkNew<vtkLightKit> lights;
  lights->SetKeyLightIntensity(0.7);
  lights->SetKeyToFillRatio(1.8);
  lights->SetKeyToHeadRatio(1.6);
  lights->AddLightsToRenderer(renderer);

  const vtkNew<vtkColorTransferFunction> map = viridis(what.low, what.high);
  const double line = std::max(1.0, options.height / 900.0);
  const double edge = mean_edge_pixels(surfaces, eye.pixels_per_metre);
  const double opacity = edge < 4 ? 0 : std::clamp(edge / 60, 0.1, 0.5);
  const Vec3 nearer = eye.direction * 2 / eye.pixels_per_metre;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    add_foil(renderer, surfaces[i], has_scale ? map.Get() : nullptr, i);
    if (opacity > 0) add_lines(renderer, surfaces[i].edges, nearer, line, opacity);
    add_lines(renderer, surfaces[i].seams, nearer, 1.5 * line, 0.9);
    add_lines(renderer, surfaces[i].borders, nearer, 2 * line, 1);
  }
  if (has_scale) add_scale(renderer, what, map, options);
  if (!options.title.empty()) {
    add_text(renderer, options.title, (has_scale ? 0.435 : 0.5) * options.width, 0.925 * options.height,
             options.height / 32.0, VTK_TEXT_CENTERED, VTK_TEXT_BOTTOM);
  }

  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetParallelScale(options.height / eye.pixels_per_metre / 2);
  camera->SetFocalPoint(eye.centre.data());
  camera->SetPosition(Vec3(eye.centre + eye.distance * eye.direction).data());
  camera->SetViewUp(eye.up.data());
  renderer->ResetCameraClippingRange();
  window->Render();
  write_png(window, options.out);
}

} // namespace pneuma::stages::picture
