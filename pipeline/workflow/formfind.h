// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/forms.h"

namespace pneuma::pipeline::workflow {

struct SolverOptions {
  std::optional<double> tolerance; // relative residual
  std::optional<int> max_iterations;

  static void declare(auto& keys) {
    keys("tolerance", &SolverOptions::tolerance, number().within({0, 1, "between 0 and 1", false, false}),
         "relative residual at which an equilibrium is accepted");
    keys("max_iterations", &SolverOptions::max_iterations, integer().between(1, 1000000, "from 1 to 1000000"),
         "per step");
  }
};

struct FormfindSettings {
  std::map<std::string, double> gauge_pressure;        // chamber -> Pa, every chamber present
  std::map<std::string, double> prestress;             // foil -> N/m, every foil present
  std::optional<std::map<std::string, double>> stress; // as the user may say it, Pa; turned into prestress
  SolverOptions options;

  static void declare(auto& keys) {
    using Self = FormfindSettings;
    const char* isotropic = "an isotropic prestress (or stress) per foil is available: {all: 0.89 kN/m}";
    keys("gauge_pressure", &Self::gauge_pressure, gauge_pressures(), "the pressure of the form");
    const Form<double> warp_weft{schema::not_available("{warp: ..., weft: ...}", isotropic), {}, {}};
    keys("prestress", &Self::prestress,
         each("foil",
              either<double>({isotropic_prestress(), warp_weft}, [](double) { return 0; })
                  .named("FOIL", "prestress of a foil or `all`"),
              true)
             .items(1, 1000),
         "force per length")
        .or_another();
    keys("stress", &Self::stress,
         each("foil",
              quantity("Pa")
                  .positive()
                  .usual(1e4, 5e7, "usually 0.01 to 50 MPa")
                  .such_as("4 MPa")
                  .named("FOIL", "stress, times the nominal thickness"),
              true)
             .items(1, 1000),
         "stress of a foil or `all`");
    keys.unavailable("sag", isotropic);
    keys.unavailable("volume", isotropic);
    keys("options", &Self::options, group<SolverOptions>().otherwise("{}"), "of the solver");
    keys.is("formfind", "finds the form of given prestress and pressure");
    keys.exactly_one({"prestress", "stress", "sag", "volume"});
  }
};

} // namespace pneuma::pipeline::workflow
