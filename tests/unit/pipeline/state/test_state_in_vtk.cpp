// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkHDFReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include "pipeline/state/state_file.h"
#include "tests/unit/pipeline/state/cushion_state.h"
#include "tests/unit/pipeline/state/temporary_folder.h"

namespace pneuma::pipeline::state {
namespace {

using geometry::ElementType;

// Checks that VTK's own reader sees `state` in the file.
void expect_in_vtk(const State& state, const std::filesystem::path& path, int cell_type) {
  const vtkNew<vtkHDFReader> reader;
  ASSERT_TRUE(reader->CanReadFile(path.c_str()));
  reader->SetFileName(path.c_str());
  reader->Update();
  auto* grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutputDataObject(0));
  ASSERT_NE(grid, nullptr);
  const geometry::Mesh& mesh = state.mesh;
  ASSERT_EQ(grid->GetNumberOfPoints(), static_cast<vtkIdType>(mesh.nodes.size()));
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(grid->GetPoint(i)[k], mesh.nodes[static_cast<std::size_t>(i)][k]);
  }
  vtkDataArray* foil = grid->GetCellData()->GetArray("foil");
  ASSERT_NE(foil, nullptr);
  vtkIdType cell = 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    for (Index e = 0; e < mesh.element_count(mesh.blocks[b]); ++e, ++cell) {
      ASSERT_LT(cell, grid->GetNumberOfCells());
      EXPECT_EQ(grid->GetCellType(cell), cell_type);
      EXPECT_EQ(foil->GetTuple1(cell), static_cast<double>(b));
      const auto nodes = mesh.element_nodes(mesh.blocks[b], e);
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        EXPECT_EQ(grid->GetCell(cell)->GetPointId(static_cast<int>(k)), nodes[k]);
      }
    }
  }
  EXPECT_EQ(grid->GetNumberOfCells(), cell);
  for (const Field& field : state.fields) {
    if (field.location == Location::gauss) continue;
    vtkDataArray* array = field.location == Location::point ? grid->GetPointData()->GetArray(field.name.c_str())
                                                            : grid->GetCellData()->GetArray(field.name.c_str());
    ASSERT_NE(array, nullptr) << field.name;
    ASSERT_EQ(array->GetNumberOfComponents(), field.components);
    ASSERT_EQ(array->GetNumberOfValues(), static_cast<vtkIdType>(field.values.size()));
    for (std::size_t i = 0; i < field.values.size(); ++i) {
      const auto row = static_cast<vtkIdType>(i) / field.components;
      EXPECT_EQ(array->GetComponent(row, static_cast<int>(i) % field.components), field.values[i]);
    }
  }
  ASSERT_NE(grid->GetFieldData()->GetArray("gauge_pressure"), nullptr);
  EXPECT_EQ(grid->GetFieldData()->GetArray("gauge_pressure")->GetTuple1(0), state.chambers[0].gauge_pressure);
}

TEST(StateInVtk, OfEveryElementIsWhatWasWritten) {
  const tests::TemporaryFolder folder;
  constexpr std::pair<ElementType, int> types[] = {
      {ElementType::T3, 5}, {ElementType::T6, 22}, {ElementType::Q4, 9}, {ElementType::Q9, 28}};
  for (const auto& [type, cell_type] : types) {
    SCOPED_TRACE(geometry::name_of(type));
    const State state = tests::cushion_state(type, 3, 2);
    write_state(state, folder / "a.hdf");
    expect_in_vtk(state, folder / "a.hdf", cell_type);
  }
}

TEST(StateInVtk, EveryStepOfASeriesIsReadable) {
  const tests::TemporaryFolder folder;
  files::Outputs outputs(folder / "a.hdf", "");
  StepSeries series(outputs);
  State state = tests::cushion_state(ElementType::T6, 2, 2);
  for (int i = 0; i < 2; ++i) {
    state.mesh.nodes.back().z() += 0.1;
    series.write(state, i);
  }
  expect_in_vtk(state, folder / "steps/0001.hdf", 22);
}

} // namespace
} // namespace pneuma::pipeline::state
