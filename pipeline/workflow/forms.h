// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/outline.h"
#include "pipeline/schema/keys.h"

// Forms that several parts of a workflow file share.
namespace pneuma::pipeline::workflow {

using base::Vec2;
using base::Vec3;

using schema::all;
using schema::At;
using schema::choice;
using schema::each;
using schema::either;
using schema::flag;
using schema::Form;
using schema::group;
using schema::integer;
using schema::items;
using schema::list;
using schema::mapped;
using schema::name_of_a;
using schema::number;
using schema::part;
using schema::quantity;
using schema::Reader;
using schema::reference_to;
using schema::table;
using schema::text;
using schema::tuple;
using schema::word;
using schema::word_or;

inline Form<double> length() {
  return quantity("m").positive().usual(0.01, 100, "usually 1 cm to 100 m").such_as("6 m");
}

inline Form<Vec2> point() { // in plan
  return schema::vector<Vec2>(quantity("m").such_as("1.5 m").named("coordinate", "coordinate in plan"));
}

inline Form<std::vector<Vec2>> points(std::size_t least) {
  return list(point().named("point", "a point in plan")).items(least, 100000);
}

// Corners of a closed line, at most so many; that the last repeats the first is taken as the same.
inline Form<std::vector<Vec2>> ring(std::size_t most = 1000) {
  return mapped<std::vector<Vec2>>(list(point().named("point", "a point in plan")).items(3, most + 1), geometry::opened,
                                   [](const std::vector<Vec2>& corners) { return corners; });
}

// A vector that is not zero, of length 1; a normalised one stays as it is to the last bit: it is read again from
// stage.yaml.
inline Form<Vec3> direction() {
  const auto given = schema::vector<Vec3>(number().named("component", "component"));
  return mapped<Vec3>(
      given.judged([](const Vec3& v) { return v.norm() > 0 ? "" : "must not be zero"; }),
      [](const Vec3& v) { return std::abs(v.norm() - 1) > 1e-14 ? Vec3(v / v.norm()) : v; },
      [](const Vec3& v) { return v; });
}

// {CHAMBER: Q}
inline Form<std::map<std::string, double>> gauge_pressures() {
  return table(quantity("Pa")
                   .usual(0, 2000, "cushions hold 200 to 800 Pa, seldom up to 2 kPa")
                   .named("CHAMBER", "pressure above the still air around"),
               "chamber");
}

// Isotropic, N/m.
inline Form<double> isotropic_prestress() {
  return quantity("N/m").positive().usual(10, 20000, "usually 0.01 to 20 kN/m");
}

} // namespace pneuma::pipeline::workflow
