// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh.h"
#include "geometry/quadrature.h"
#include "pipeline/workflow/forms.h"

namespace pneuma::pipeline::workflow {

enum class MeshPattern : std::uint8_t { structured, unstructured };

struct MeshSettings {
  geometry::ElementType element = geometry::ElementType::T6;
  std::optional<double> size;                  // m
  std::optional<std::array<int, 2>> divisions; // along length and width
  std::optional<MeshPattern> pattern;          // none: structured where the plan allows
  geometry::StressRule stress_rule = geometry::StressRule::full;

  static void declare(auto& keys) {
    using Self = MeshSettings;
    using geometry::ElementType;
    using geometry::StressRule;
    keys("element", &Self::element,
         choice<ElementType>({{"T3", ElementType::T3, "linear triangle"},
                              {"T6", ElementType::T6, "quadratic triangle"},
                              {"Q4", ElementType::Q4, "linear quadrangle"},
                              {"Q9", ElementType::Q9, "quadratic quadrangle"}})
             .otherwise("T6"),
         "membrane element");
    keys("size", &Self::size, length().such_as("0.15 m"), "wanted size of the elements");
    const auto count = [](const char* where) {
      return integer().between(1, 10000, "from 1 to 10000").named("n", where);
    };
    const auto same = mapped<std::array<int, 2>>(
        count("in both directions"),
        [](int n) {
          return std::array{n, n};
        },
        [](const std::array<int, 2>& n) { return n[0]; });
    keys("divisions", &Self::divisions,
         either<std::array<int, 2>>({same, tuple<2>(count("in one direction")).named("pair", "along length and width")},
                                    [](const std::array<int, 2>& n) { return n[0] == n[1] ? 0 : 1; }),
         "number of elements along the edges");
    keys("pattern", &Self::pattern,
         choice<MeshPattern>(
             {{"structured", MeshPattern::structured, "regular"}, {"unstructured", MeshPattern::unstructured, "free"}}),
         "of the mesh; without it structured where the plan allows");
    keys("stress_rule", &Self::stress_rule,
         choice<StressRule>({{"full", StressRule::full, "T3 1, T6 3, Q4 2x2, Q9 3x3 points"},
                             {"reduced", StressRule::reduced, "2x2 points, Q9 only"}})
             .otherwise("full"),
         "integration points of the stresses");
    keys.exactly_one({"size", "divisions"});
  }
  static void check(Reader& reader, const At<MeshSettings>& mesh);
};

} // namespace pneuma::pipeline::workflow
