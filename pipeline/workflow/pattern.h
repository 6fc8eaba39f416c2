// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/formfind.h"
#include "pipeline/workflow/limits.h"

namespace pneuma::pipeline::workflow {

enum class CuttingLines : std::uint8_t { geodesic, straight };
enum class ChosenBy : std::uint8_t { distortion, waste };

inline Form<double> ratio() {
  return quantity("1").within({0, 0.5, "at least 0 % and below 50 %", true, false}).usual(0, 0.02, "usually up to 2 %");
}

// The film as bought, m.
struct Roll {
  double width = 0;
  double weld = 0;     // width of the overlap
  double selvedge = 0; // not used along both edges

  static void declare(auto& keys) {
    keys("width", &Roll::width, quantity("m").positive().usual(0.5, 3, "rolls are 0.5 to 3 m wide").such_as("1.55 m"),
         "of the film as bought");
    keys("weld", &Roll::weld,
         quantity("m").at_least(0, "at least 0 m").usual(0.005, 0.03, "usually 5 to 30 mm").such_as("12 mm"),
         "width of the overlap");
    keys("selvedge", &Roll::selvedge, quantity("m").at_least(0, "at least 0 m").such_as("10 mm"),
         "not used along both edges");
  }
  static void check(Reader& reader, const At<Roll>& roll);
};

// How much smaller than the form the strips are cut, so that they stretch to it.
enum class CompensatedBy : std::uint8_t { nothing, strain }; // strain: of the form's prestress

struct GivenCompensation { // flat length = (1 - value) x length on the form
  double warp = 0, weft = 0;

  static void declare(auto& keys) {
    keys("warp", &GivenCompensation::warp, ratio(), "along the roll");
    keys("weft", &GivenCompensation::weft, ratio(), "across the roll");
  }
};

using Compensation = std::variant<CompensatedBy, GivenCompensation>;

struct Allowance {
  double clamp = 0;   // m, of film beyond the clamped edge
  double notches = 0; // m, distance of the marks along the seams

  static void declare(auto& keys) {
    keys("clamp", &Allowance::clamp,
         quantity("m")
             .at_least(0, "at least 0 m")
             .usual(0, 0.5, "usually up to 0.5 m")
             .such_as("30 mm")
             .otherwise("30 mm"),
         "of film beyond the clamped edge");
    keys("notches", &Allowance::notches,
         quantity("m").positive().usual(0.02, 10, "usually 2 cm to 10 m").such_as("0.5 m").otherwise("0.5 m"),
         "distance of the marks along the seams");
  }
};

using PlanCurves = std::vector<std::vector<Vec2>>; // m

struct PatternSettings {
  // what decides the layout: a number of strips, the roll (the fewest strips that fit), or given curves
  std::optional<int> strips_per_foil;
  std::optional<Roll> roll;                 // then every strip must fit on it
  std::map<std::string, PlanCurves> curves; // foil -> curves in plan
  CuttingLines lines = CuttingLines::geodesic;
  std::optional<double> direction; // rad, of the strips' length from the plan's x axis; none: auto
  ChosenBy chosen_by = ChosenBy::distortion;
  Compensation compensation;
  double creep = 0;          // beside the elastic strain, in both directions
  double decompensation = 0; // m, width of the zone along clamped edges where the compensation fades in; 0: none
  std::optional<std::vector<std::string>> foils; // to be cut; none: all that are not flat
  Allowance allowance;
  SolverOptions options;

  // The roll, or one as film is bought, which drawings are laid on where none is given.
  Roll roll_or_usual() const { return roll.value_or(Roll{1.55, 0.012, 0.01}); }
  bool by_strain() const {
    const auto* by = std::get_if<CompensatedBy>(&compensation);
    return by != nullptr && *by == CompensatedBy::strain;
  }
  bool compensates() const { return by_strain() || std::holds_alternative<GivenCompensation>(compensation); }

  static void declare(auto& keys) {
    using Self = PatternSettings;
    const auto searches = [](const auto& pattern) { return pattern.curves.empty(); };
    const char* beside_curves = "has no effect beside `curves`, which are the seams themselves";
    keys("strips_per_foil", &Self::strips_per_foil,
         integer().between(2, most_strips, "from 2 to 200").usual(2, 50, "usually 2 to 50"), "number of strips");
    keys("roll", &Self::roll, group<Roll>(),
         "the film: every strip must fit on it; alone it gives the fewest strips that fit");
    keys("lines", &Self::lines,
         choice<CuttingLines>({{"geodesic", CuttingLines::geodesic, "shortest on the form"},
                               {"straight", CuttingLines::straight, "straight in plan"}})
             .otherwise("geodesic"),
         "the seams' kind")
        .where(searches, beside_curves);
    keys("direction", &Self::direction,
         word_or("auto", "the best one is searched", quantity("rad").named("angle", "from x")).otherwise("auto"),
         "of the strips' length")
        .where(searches, beside_curves);
    keys("chosen_by", &Self::chosen_by,
         choice<ChosenBy>({{"distortion", ChosenBy::distortion, "least stretched when flattened"},
                           {"waste", ChosenBy::waste, "least film"}})
             .otherwise("distortion"),
         "what the best direction is")
        .where([](const auto& pattern) { return pattern.curves.empty() && !pattern.direction; },
               "has no effect beside `curves` or a given `direction`: it chooses among directions");
    keys("curves", &Self::curves,
         each("foil",
              list(points(2).items(2, 10000).named("curve", "points in plan from rim to rim"))
                  .items(1, most_strips - 1)
                  .named("FOIL", "of a foil or `all`"),
              false) // of those that are cut
             .items(1, 1000),
         "the seams")
        .or_another();
    const auto compensated_by =
        choice<CompensatedBy>({{"none", CompensatedBy::nothing, "the strips are as large as the form"},
                               {"elastic", CompensatedBy::strain, "by the strain of the form's prestress"}});
    keys("compensation", &Self::compensation,
         either<Compensation>({schema::as<Compensation>(compensated_by.named("kind", "what decides it")),
                               schema::as<Compensation>(group<GivenCompensation>().named(
                                   "given", "flat length = (1 - value) x length on the form"))},
                              [](const Compensation& value) { return value.index(); })
             .otherwise("none"),
         "how much smaller the strips are cut than the form");
    keys("creep", &Self::creep, ratio().otherwise("0 %"), "beside the elastic strain")
        .where([](const auto& pattern) { return pattern.by_strain(); },
               "is for `compensation: elastic`, to which it is added");
    keys("decompensation", &Self::decompensation,
         quantity("m").at_least(0, "at least 0 m").usual(0, 2, "usually up to 2 m").such_as("0.3 m").otherwise("0 m"),
         "width along clamped edges where the compensation fades in")
        .where([](const auto& pattern) { return pattern.compensates(); },
               "is for `compensation: elastic` or {warp: ..., weft: ...}, which it lets fade in");
    keys("foils", &Self::foils, list(reference_to("foil").named("foil", "a foil")).items(1, 16),
         "to be cut; without it all that are not flat");
    keys("allowance", &Self::allowance, group<Allowance>().otherwise("{}"), "what is added to the net strips");
    keys("options", &Self::options, group<SolverOptions>().otherwise("{}"), "of the solver");
    keys.is("pattern", "cuts a found form into flat strips");
    keys.at_least_one({"strips_per_foil", "roll", "curves"});
    keys.not_both("strips_per_foil", "curves");
  }
  static void check(Reader& reader, const At<PatternSettings>& pattern);
};

} // namespace pneuma::pipeline::workflow
