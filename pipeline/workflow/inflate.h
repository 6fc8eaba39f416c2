// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/workflow/path.h"

namespace pneuma::pipeline::workflow {

enum class Reference : std::uint8_t { prestressed, stress_free };

struct InflateSettings : PathSettings {
  std::map<std::string, double> gauge_pressure;           // chamber -> Pa
  std::optional<Reference> reference;                     // required from a formfind stage
  std::optional<std::map<std::string, double>> prestress; // foil -> N/m; only from `mesh`; none: stress-free

  static void declare(auto& keys) {
    using Self = InflateSettings;
    keys("gauge_pressure", &Self::gauge_pressure, gauge_pressures(), "reached with regulated air");
    keys("reference", &Self::reference,
         choice<Reference>({{"prestressed", Reference::prestressed, "the found form carries its prestress"},
                            {"stress_free", Reference::stress_free, "the found form is free of stress"}}),
         "of a found form");
    keys("prestress", &Self::prestress,
         each("foil", isotropic_prestress().named("prestress", "force per length, the same in all directions"), true)
             .items(1, 1000),
         "of a flat start, per foil or `all`");
    PathSettings::declare(keys);
    keys.is("inflate", "raises the pressure");
  }
};

} // namespace pneuma::pipeline::workflow
