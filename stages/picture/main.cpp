// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/base/errors.h"
#include "geometry/base/types.h"
#include "pipeline/state/state_file.h"
#include "stages/picture/draw.h"

namespace pneuma::stages::picture {

int run(int argc, char** argv) {
  const std::optional<Options> options = parse(argc, argv);
  if (options) draw(pipeline::state::read_state(options->state), *options);
  return 0;
}

} // namespace pneuma::stages::picture

int main(int argc, char** argv) {
  return pneuma::base::guarded_main("pneuma-picture", [&] { return pneuma::stages::picture::run(argc, argv); });
}
