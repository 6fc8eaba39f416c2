// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/formfind.h"

// How inflate and wind stages follow their path.
namespace pneuma::pipeline::workflow {

struct Steps {
  std::optional<int> steps; // output at n equal parts of the path, or of each stretch between two moments

  static void declare(auto& keys) {
    keys("steps", &Steps::steps, integer().between(1, 100000, "from 1 to 100000"),
         "output at n equal parts of the path");
  }
};

struct LoadControl : Steps {
  static void declare(auto& keys) {
    Steps::declare(keys);
    keys.is("load", "the load grows; automatic steps");
  }
};

struct DisplacementControl : Steps {
  std::optional<Vec2> at; // m, in plan; none: the largest displacement of the foil
  std::string foil;
  std::optional<Vec3> direction; // of the controlled displacement, unit length; none: the site's up
  double until = 0;              // m, not zero; its sign counts along the direction

  static void declare(auto& keys) {
    using Self = DisplacementControl;
    keys("at", &Self::at,
         word_or("max", "the largest displacement of the foil", point().named("place", "a point of the foil, in plan"))
             .otherwise("max"),
         "what is controlled");
    keys("foil", &Self::foil, reference_to("foil"), "where there are several").or_another();
    keys("direction", &Self::direction, workflow::direction(),
         "of the displacement at a place; without it the site's up")
        .where([](const auto& control) { return control.at.has_value(); },
               "is for a displacement at a place, not the largest (`at: max`)");
    keys("until", &Self::until,
         quantity("m").judged([](double end) { return end != 0 ? "" : "must not be zero"; }).such_as("0.1 m"),
         "the displacement in the end; its sign counts along the direction");
    Steps::declare(keys);
    keys.is("displacement", "a displacement grows, the load follows");
  }
  static void check(Reader& reader, const At<DisplacementControl>& control);
};

struct VolumeControl : Steps {
  std::string chamber;
  double until = 0; // m3

  static void declare(auto& keys) {
    keys("chamber", &VolumeControl::chamber, reference_to("chamber"), "where there are several").or_another();
    keys("until", &VolumeControl::until, quantity("m3").positive().such_as("5 m3"), "the volume in the end");
    Steps::declare(keys);
    keys.is("volume", "the volume of a chamber changes, the load follows");
  }
};

// The path ends at the first of these that is reached; at least one is given.
struct ArcTargets {
  std::optional<double> load_factor, pressure, volume, displacement; // -, Pa (gauge), m3, m
  std::optional<double> after_peak;                                  // the load fell to this part of its peak, 0 .. 1

  static void declare(auto& keys) {
    using Self = ArcTargets;
    keys("load_factor", &Self::load_factor, number().positive(), "1: everything that the stage states");
    keys("pressure", &Self::pressure, quantity("Pa"), "gauge pressure of the chamber");
    keys("volume", &Self::volume, quantity("m3").positive().such_as("5 m3"), "of the chamber");
    keys("displacement", &Self::displacement, quantity("m").positive().such_as("0.1 m"),
         "largest of the foil, or of all");
    keys("after_peak", &Self::after_peak, number().within({0, 1, "between 0 and 1", false, false}),
         "the load fell to this part of its peak");
    keys.at_least_one({"load_factor", "pressure", "volume", "displacement", "after_peak"});
  }
};

struct ArcLengthControl : Steps {
  ArcTargets until;
  std::optional<std::string> chamber; // of pressure and volume; filled in where there is only one
  std::optional<std::string> foil;    // of displacement (largest); none: of all foils

  bool needs_chamber() const { return until.pressure || until.volume; }

  static void declare(auto& keys) {
    using Self = ArcLengthControl;
    keys("until", &Self::until, group<ArcTargets>(), "the path ends at the first that is reached");
    keys("chamber", &Self::chamber, reference_to("chamber"), "where there are several")
        .where([](const auto& control) { return control.needs_chamber(); },
               "is for `until: {pressure: ...}` or `{volume: ...}`");
    keys("foil", &Self::foil, reference_to("foil"), "where there are several")
        .where([](const auto& control) { return control.until.displacement.has_value(); },
               "is for `until: {displacement: ...}`");
    Steps::declare(keys);
    keys.is("arc_length", "a length along the path grows, load and displacement follow");
  }
};

using Control = std::variant<LoadControl, DisplacementControl, VolumeControl, ArcLengthControl>;

inline std::optional<int> steps_of(const Control& control) {
  return std::visit([](const Steps& one) { return one.steps; }, control);
}

// What part of a stage's load acts when.
struct Moment {
  double time = 0; // s
  double factor = 0;

  static void declare(auto& keys) {
    keys("time", &Moment::time, quantity("s").at_least(0, "at least 0 s"), "since the stage began");
    keys("factor", &Moment::factor, number(), "part of what the stage states that acts then");
  }
};

struct PathOptions : SolverOptions {
  std::optional<int> max_steps;
  double plastic_step = 0; // growth of the equivalent plastic strain in a step

  static void declare(auto& keys) {
    SolverOptions::declare(keys);
    keys("max_steps", &PathOptions::max_steps, integer().between(1, 100000, "from 1 to 100000"),
         "after so many the path is given up; without it after 500, under load control as many as it takes");
    keys("plastic_step", &PathOptions::plastic_step,
         number().within({0, 1, "above 0, up to 1", false, true}).otherwise("0.02"),
         "the most that the equivalent plastic strain of a yielding foil grows in a step");
  }
};

struct PathSettings {
  bool contact_stops = true;
  bool snaps = false; // under load control, where the cushion loses its shape
  Control control;
  std::vector<Moment> history; // of load control, from nothing at 0 s, linear between; empty: no time passes
  PathOptions options;

  static void declare(auto& keys) {
    using Self = PathSettings;
    keys("contact", &Self::contact_stops,
         choice<bool>({{"stop", true, "ends the stage"}, {"ignore", false, "goes on, marked"}}).otherwise("stop"),
         "what happens when foils meet");
    const auto under_load = [](const auto& path) { return std::holds_alternative<LoadControl>(path.control); };
    keys("after_limit", &Self::snaps,
         choice<bool>({{"stop", false, "ends the stage"}, {"snap", true, "goes on to the state it jumps to, marked"}})
             .otherwise("stop"),
         "what happens where the cushion loses its shape under the load")
        .where(under_load, "is for load control: another goes on through limit points");
    const auto in_a_word = mapped<Control>(
        choice<bool>({{"load", true, "the load grows; automatic steps"}}).named("word", "in a word"),
        [](bool) { return Control(LoadControl{}); }, [](const Control&) { return true; });
    keys("control", &Self::control,
         either<Control>({in_a_word, schema::variant<Control>("type").named("path", "by type")},
                         [](const Control&) { return 1; })
             .otherwise("load"),
         "how the path is followed");
    const char* no_time = "is for load control: on the path of another no time passes";
    const auto evenly = mapped<std::vector<Moment>>(
        quantity("s").positive().usual(1e-3, 1e10, "usually from milliseconds to 100 years"),
        [](double duration) {
          return std::vector<Moment>{{duration, 1}};
        },
        [](const auto&) -> const double* { return nullptr; });
    keys("duration", &Self::history, evenly.stands_for("history.0.time"),
         "in which all that the stage states grows evenly; without it no time passes")
        .or_another()
        .where(under_load, no_time);
    keys("history", &Self::history, list(group<Moment>().named("moment", "a moment")).items(1, 100000),
         "what acts when, from nothing at 0 s, linear between")
        .or_another()
        .where(under_load, no_time);
    keys("options", &Self::options, group<PathOptions>().otherwise("{}"), "of the solver");
    keys.not_both("duration", "history");
  }
  static void check(Reader& reader, const At<PathSettings>& path);
};

} // namespace pneuma::pipeline::workflow
