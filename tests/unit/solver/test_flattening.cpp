// SPDX-License-Identifier: GPL-3.0-or-later
// Flat strips: derivatives, developable surfaces, mating seams, distortion against width.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "geometry/flattening/parameterization.h"
#include "geometry/flattening/rotation.h"
#include "geometry/meshing/plan_mesh.h"
#include "solver/flattening/flattening.h"
#include "tests/unit/finite_differences.h"

namespace pneuma::tests {

namespace {

using namespace solver::flattening;
using base::Vec2;
using base::VecX;
using geometry::ElementType;
using geometry::meshing::Pattern;
using Shape = std::function<Vec3(double, double)>;

constexpr ElementType all_elements[] = {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9};

// A rectangle of the plan on a surface, cut along y = 0 where `strips` is 2.
struct Example {
  geometry::Mesh mesh;
  std::vector<Index> strip_of_element;
  FlatNodes nodes;
  Problem problem;
  std::vector<Vec2> start;

  Example(ElementType element, double length, double width, std::array<int, 2> divisions, const Shape& shape,
          Index strips = 1, Pattern pattern = Pattern::structured)
      : mesh(geometry::meshing::mesh_plan(geometry::Rectangle{length, width}, {element, {}, divisions, pattern})) {
    const geometry::Block& block = mesh.blocks.front();
    for (Index e = 0; e < mesh.element_count(block); ++e) {
      double y = 0;
      for (const Index node : mesh.element_nodes(block, e)) y += mesh.nodes[static_cast<std::size_t>(node)].y();
      strip_of_element.push_back(strips == 2 && y > 0 ? 1 : 0);
    }
    for (Vec3& x : mesh.nodes) x = shape(x.x(), x.y());
    nodes = flat_nodes(element, block.connectivity, strip_of_element, strips);
    problem.element = element;
    problem.nodes = &nodes;
    for (const Index node : nodes.node) problem.form.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
  }
  Example(const Example&) = delete;

  // the surface as triangles, all strips next to each other
  std::vector<Vec2> conformal_start() const {
    std::vector<Vec2> plane(nodes.node.size());
    const Index strips = nodes.strip.back() + 1;
    for (Index strip = 0; strip < strips; ++strip) {
      geometry::Triangulation surface;
      std::vector<Index> number(nodes.node.size(), -1);
      std::vector<std::size_t> flat;
      for (std::size_t i = 0; i < nodes.node.size(); ++i) {
        if (nodes.strip[i] != strip) continue;
        number[i] = static_cast<Index>(flat.size());
        flat.push_back(i);
        surface.points.push_back(problem.form[i]);
      }
      const auto n = static_cast<std::size_t>(geometry::nodes_per_element(mesh.element));
      static const std::vector<std::array<std::size_t, 3>> parts[] = {
          {{0, 1, 2}},
          {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}},
          {{0, 1, 2}, {0, 2, 3}},
          {{0, 4, 8}, {0, 8, 7}, {4, 1, 5}, {4, 5, 8}, {8, 5, 2}, {8, 2, 6}, {7, 8, 6}, {7, 6, 3}}};
      for (std::size_t e = 0; e < strip_of_element.size(); ++e) {
        if (strip_of_element[e] != strip) continue;
        for (const auto& [a, b, c] : parts[static_cast<int>(mesh.element)]) {
          const auto corner = [&](std::size_t k) {
            return number[static_cast<std::size_t>(nodes.connectivity[e * n + k])];
          };
          surface.triangles.push_back({corner(a), corner(b), corner(c)});
        }
      }
      std::vector<Vec2> plan;
      for (const Vec3& x : surface.points) plan.emplace_back(x.x(), x.y());
      const std::vector<Vec2> points = geometry::flattening::laid_over(geometry::flattening::conformal(surface), plan);
      for (std::size_t i = 0; i < flat.size(); ++i) plane[flat[i]] = points[i];
    }
    return plane;
  }

  // sides along the seam at y = 0, strip 0 against strip 1
  void tie_seam() {
    std::vector<std::pair<double, std::array<Index, 2>>> seam; // x, flat nodes in both strips
    for (std::size_t i = 0; i < nodes.node.size(); ++i) {
      for (std::size_t j = i + 1; j < nodes.node.size(); ++j) {
        if (nodes.node[i] == nodes.node[j] && nodes.strip[i] != nodes.strip[j])
          seam.push_back({problem.form[i].x(), {static_cast<Index>(i), static_cast<Index>(j)}});
      }
    }
    std::sort(seam.begin(), seam.end());
    for (std::size_t k = 0; k + 1 < seam.size(); ++k) {
      problem.ties.push_back({{seam[k].second[0], seam[k + 1].second[0]}, {seam[k].second[1], seam[k + 1].second[1]}});
    }
  }
};

double largest_distortion(const Problem& problem, const std::vector<Vec2>& points) {
  double worst = 0;
  for (const PointStretch& s : stretches(problem, points)) {
    worst = std::max({worst, std::abs(s.larger - 1), std::abs(s.smaller - 1)});
  }
  return worst;
}

// root mean square over the form
double mean_distortion(const Problem& problem, const std::vector<Vec2>& points) {
  double sum = 0;
  double area = 0;
  for (const PointStretch& s : stretches(problem, points)) {
    sum += s.area * (std::pow(s.larger - 1, 2) + std::pow(s.smaller - 1, 2));
    area += s.area;
  }
  return std::sqrt(sum / area);
}

Vec3 cylinder(double x, double y) {
  constexpr double radius = 0.7; // axis along x
  return {x, radius * std::sin(y / radius), radius * std::cos(y / radius)};
}

Vec3 sphere(double x, double y) {
  constexpr double radius = 4;
  return {x, y, std::sqrt(radius * radius - x * x - y * y)};
}

Vec3 saddle(double x, double y) {
  return {x, y, (x * x - y * y) / 8};
}

TEST(Flattening, GradientIsTheDerivativeOfTheValue) {
  for (const ElementType element : all_elements) {
    Example example(element, 2, 1, {2, 2}, sphere, 2);
    example.tie_seam();
    example.problem.weight << 2.0, 0.7, 0.1, 0.7, 1.4, 0.05, 0.1, 0.05, 0.9;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> noise(-0.01, 0.01);
    const std::size_t points = static_cast<std::size_t>(example.mesh.element_count(example.mesh.blocks[0])) *
                               geometry::stress_rule(element).size();
    for (std::size_t k = 0; k < points; ++k) {
      example.problem.stretch.insert(example.problem.stretch.end(),
                                     {1 + noise(random), 1 + noise(random), noise(random)});
    }
    VecX x(2 * static_cast<Eigen::Index>(example.nodes.node.size()));
    for (std::size_t i = 0; i < example.nodes.node.size(); ++i) {
      x[static_cast<Eigen::Index>(2 * i)] = example.problem.form[i].x() + noise(random);
      x[static_cast<Eigen::Index>(2 * i + 1)] = example.problem.form[i].y() + noise(random);
    }
    const std::vector<double> multipliers(example.problem.ties.size(), 0.3);
    const auto at = [&](const VecX& coordinates) {
      std::vector<Vec2> moved;
      for (Eigen::Index i = 0; i < coordinates.size(); i += 2) moved.emplace_back(coordinates[i], coordinates[i + 1]);
      return evaluate(example.problem, moved, multipliers, 5.0);
    };
    const Value value = at(x);
    const auto gradient =
        finite_difference_jacobian([&](const VecX& y) { return VecX::Constant(1, at(y).value); }, x, 1e-4);
    EXPECT_LT(relative_difference(value.gradient.transpose(), gradient), 1e-9) << geometry::name_of(element);
  }
}

TEST(Flattening, MatrixIsTheSecondDerivativeWhereNothingIsMissed) {
  for (const ElementType element : all_elements) {
    Example example(
        element, 2, 1, {2, 2}, [](double x, double y) { return Vec3(x, y, 0); }, 2);
    example.tie_seam();
    example.problem.weight << 2.0, 0.7, 0.1, 0.7, 1.4, 0.05, 0.1, 0.05, 0.9;
    VecX x(2 * static_cast<Eigen::Index>(example.nodes.node.size()));
    for (std::size_t i = 0; i < example.nodes.node.size(); ++i) {
      x.segment<2>(static_cast<Eigen::Index>(2 * i)) = example.problem.form[i].head<2>();
    }
    const std::vector<double> multipliers(example.problem.ties.size(), 0.0);
    const auto at = [&](const VecX& coordinates) {
      std::vector<Vec2> moved;
      for (Eigen::Index i = 0; i < coordinates.size(); i += 2) moved.emplace_back(coordinates[i], coordinates[i + 1]);
      return evaluate(example.problem, moved, multipliers, 5.0);
    };
    const auto hessian = finite_difference_jacobian([&](const VecX& y) { return at(y).gradient; }, x, 1e-4);
    EXPECT_LT(relative_difference(at(x).matrix, hessian), 1e-8) << geometry::name_of(element);
  }
}

TEST(Flattening, ACylinderMeshedAlongItsGeneratorsUnrollsExactly) {
  // facets between generators are plane, and so are quadratic elements' nodes on lines of constant y
  for (const ElementType element : {ElementType::T3, ElementType::Q4}) {
    Example example(element, 2, 1, {8, 6}, cylinder);
    const Flat flat = flatten(example.problem, example.conformal_start());
    EXPECT_TRUE(flat.converged);
    EXPECT_LT(largest_distortion(example.problem, flat.points), 1e-12) << geometry::name_of(element);
  }
}

TEST(Flattening, OnAnUnstructuredCylinderTheErrorFallsWithTheSquareOfTheElementSize) {
  for (const ElementType element : {ElementType::T3, ElementType::T6}) {
    double error[3];
    int n = 4;
    for (double& e : error) {
      Example example(element, 2, 1, {2 * n, n}, cylinder, 1, Pattern::unstructured);
      const Flat flat = flatten(example.problem, example.conformal_start());
      ASSERT_TRUE(flat.converged);
      e = mean_distortion(example.problem, flat.points);
      std::printf("cylinder, %s, %d divisions: distortion mean %.3e, largest %.3e; %d iterations\n",
                  geometry::name_of(element), n, e, largest_distortion(example.problem, flat.points), flat.iterations);
      n *= 2;
    }
    EXPECT_GT(std::log2(error[0] / error[2]) / 2, 1.7) << geometry::name_of(element);
  }
}

TEST(Flattening, DistortionFallsWithTheSquareOfTheStripWidth) {
  for (const auto& [name, shape] : {std::pair<const char*, Shape>{"sphere", sphere}, {"saddle", saddle}}) {
    double error[3];
    double width = 1.2;
    for (double& e : error) {
      Example example(ElementType::T6, 4, width, {40, 8}, shape);
      const Flat flat = flatten(example.problem, example.conformal_start());
      ASSERT_TRUE(flat.converged);
      e = largest_distortion(example.problem, flat.points);
      std::printf("%s, width %.2f m: largest distortion %.3e, %d iterations\n", name, width, e, flat.iterations);
      width /= 2;
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.2) << name;
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.2) << name;
  }
}

TEST(Flattening, MatingSeamsComeOutEquallyLong) {
  for (const ElementType element : all_elements) {
    // one strip is flat, the other curved: apart they would be of different lengths along the seam
    const Shape shape = [](double x, double y) { return Vec3(x, y, y > 0 ? 0.15 * y * (4 - x * x) : 0); };
    Example example(element, 4, 2, {12, 6}, shape, 2);
    const std::vector<Vec2> start = example.conformal_start();
    const auto mismatch = [&](const std::vector<Vec2>& points) {
      double worst = 0;
      Example tied(element, 4, 2, {12, 6}, shape, 2);
      tied.tie_seam();
      for (const LengthTie& tie : tied.problem.ties) {
        const auto length = [&](const Index(&side)[2]) {
          return (points[static_cast<std::size_t>(side[1])] - points[static_cast<std::size_t>(side[0])]).norm();
        };
        worst = std::max(worst, std::abs(length(tie.a) - length(tie.b)));
      }
      return worst;
    };
    const Flat apart = flatten(example.problem, start);
    example.tie_seam();
    const Flat tied = flatten(example.problem, start);
    EXPECT_TRUE(tied.converged);
    EXPECT_GT(mismatch(apart.points), 1e-5) << geometry::name_of(element);
    EXPECT_LT(mismatch(tied.points), 1e-11) << geometry::name_of(element);
  }
}

TEST(Flattening, CompensationShortensByTheWantedStretch) {
  Example example(ElementType::T3, 2, 1, {8, 6}, cylinder);
  const std::size_t points = example.mesh.blocks[0].connectivity.size() / 3;
  for (std::size_t k = 0; k < points; ++k) {
    example.problem.stretch.insert(example.problem.stretch.end(), {1 / (1 - 0.003), 1 / (1 - 0.002), 0});
  }
  const Flat flat = flatten(example.problem, example.conformal_start());
  double length = 0;
  for (const Vec2& a : flat.points) {
    for (const Vec2& b : flat.points) length = std::max(length, std::abs(a.x() - b.x()));
  }
  EXPECT_NEAR(length, 2 * (1 - 0.003), 1e-9);
  double error = 0;
  for (const PointStretch& s : stretches(example.problem, flat.points)) {
    error = std::max({error, std::abs(std::sqrt(s.inverse_metric(0, 0)) - (1 - 0.003)),
                      std::abs(std::sqrt(s.inverse_metric(1, 1)) - (1 - 0.002))});
  }
  EXPECT_LT(error, 1e-9);
}

} // namespace

} // namespace pneuma::tests
