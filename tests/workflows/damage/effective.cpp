// SPDX-License-Identifier: GPL-3.0-or-later
// effective WORKFLOW.yaml FOLDER: what the programs take from a workflow file, a stage.yaml for each stage:
// FOLDER/N.yaml with N from 0 in the order of the file. A program of its own, as the reader under test may end in any
// way.
#include <cstdio>
#include <fstream>

#include "pipeline/workflow/settings.h"

int main(int argc, char** argv) {
  namespace workflow = pneuma::pipeline::workflow;
  if (argc != 3) return 2;
  const workflow::ReadResult read = workflow::read_workflow(argv[1]);
  for (const workflow::Problem& problem : read.problems) {
    std::fprintf(stderr, "%s\n", to_string(problem).c_str());
    if (problem.error) return 2;
  }
  int number = 0;
  for (const workflow::StageSettings& stage : read.workflow.stages) {
    std::ofstream(std::string(argv[2]) + "/" + std::to_string(number++) + ".yaml")
        << workflow::stage_yaml(read.workflow, stage);
    std::printf("%s %s\n", stage.run.c_str(), stage.id.c_str());
  }
  return 0;
}
