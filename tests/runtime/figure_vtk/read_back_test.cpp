// The exported surfaces, read by VTK's own readers.
#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStructuredGrid.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLMultiBlockDataReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <bit>
#include <cstdint>

#include "figure/module/errors.hpp"
#include "figure_samples.hpp"

namespace {

using namespace samples;

/// A grid whose numbers have no short decimal form, with one value that carries no data.
Scene uneven() {
  Scene figure = scene();
  figure.clouds[0].x.resize(5);
  figure.clouds[0].y.resize(5);
  figure.clouds[0].z.resize(5);
  for (double& x : figure.grid_x) x += 1e-3 / 3.0;
  return figure;
}

void expect_same_bits(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b));
}

class ReadBack : public testing::Test {
 protected:
  Folder folder;
  FigureModule module{module_file()};
};

TEST_F(ReadBack, the_structured_grid_has_the_same_numbers_bit_for_bit) {
  const Scene figure = uneven();
  module.export_surface(in_figure(figure), folder / "s.vts");
  vtkNew<vtkXMLStructuredGridReader> reader;
  reader->SetFileName((folder / "s.vts").c_str());
  reader->Update();
  vtkStructuredGrid* grid = reader->GetOutput();
  ASSERT_EQ(grid->GetNumberOfPoints(), 41 * 41);
  vtkDataArray* y = grid->GetPointData()->GetArray("y [m]");
  vtkDataArray* v = grid->GetPointData()->GetArray("v [m/s]");
  vtkDataArray* force = grid->GetPointData()->GetArray("restoring force [N]");
  ASSERT_TRUE(y && v && force);
  EXPECT_EQ(force->GetDataType(), VTK_DOUBLE);
  int holes = 0;
  for (int row = 0; row < 41; ++row)
    for (int column = 0; column < 41; ++column) {
      const vtkIdType id = row * 41 + column;
      const double z = figure.surface(row, column);
      expect_same_bits(y->GetTuple1(id), figure.grid_x[static_cast<std::size_t>(column)]);
      expect_same_bits(v->GetTuple1(id), figure.grid_y[static_cast<std::size_t>(row)]);
      EXPECT_EQ(grid->IsPointVisible(id) != 0, !std::isnan(z));
      if (std::isnan(z)) {
        ++holes;
        EXPECT_TRUE(std::isnan(force->GetTuple1(id)));
        continue;
      }
      expect_same_bits(force->GetTuple1(id), z);
      expect_same_bits(grid->GetPoint(id)[0], figure.grid_x[static_cast<std::size_t>(column)]);
      expect_same_bits(grid->GetPoint(id)[2], z);
    }
  EXPECT_GT(holes, 0);
}

TEST_F(ReadBack, the_polydata_holds_the_cells_with_data_and_the_samples) {
  const Scene figure = uneven();
  module.export_surface(in_figure(figure), folder / "s.vtp");
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder / "s.vtp").c_str());
  reader->Update();
  vtkPolyData* data = reader->GetOutput();
  int cells = 0;
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c) cells += !figure.surface.block(r, c, 2, 2).hasNaN();
  EXPECT_EQ(data->GetNumberOfPolys(), cells);
  ASSERT_EQ(data->GetNumberOfVerts(), 5);
  vtkDataArray* force = data->GetPointData()->GetArray("restoring force [N]");
  vtkDataArray* part = data->GetCellData()->GetArray("part");
  ASSERT_TRUE(force && part);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(part->GetTuple1(i), 1.0);
    expect_same_bits(force->GetTuple1(41 * 41 + i), figure.clouds[0].z[static_cast<std::size_t>(i)]);
  }
  EXPECT_EQ(part->GetTuple1(5), 0.0);
}

TEST_F(ReadBack, the_unstructured_grid_has_the_same_cells) {
  const Scene figure = uneven();
  module.export_surface(in_figure(figure), folder / "s.vtu");
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "s.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid* data = reader->GetOutput();
  int cells = 0;
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c) cells += !figure.surface.block(r, c, 2, 2).hasNaN();
  ASSERT_EQ(data->GetNumberOfCells(), cells + 5);
  EXPECT_EQ(data->GetCellType(0), VTK_VERTEX);
  EXPECT_EQ(data->GetCellType(5), VTK_QUAD);
  vtkDataArray* force = data->GetPointData()->GetArray("restoring force [N]");
  ASSERT_TRUE(force && data->GetCellData()->GetArray("part"));
  vtkIdList* corners = data->GetCell(5)->GetPointIds();
  for (vtkIdType k = 0; k < 4; ++k) {
    const vtkIdType id = corners->GetId(k);
    expect_same_bits(force->GetTuple1(id), figure.surface(id / 41, id % 41));
  }
}

TEST_F(ReadBack, the_blocks_hold_the_grid_and_the_samples) {
  const Scene figure = uneven();
  module.export_surface(in_figure(figure), folder / "s.vtm");
  vtkNew<vtkXMLMultiBlockDataReader> reader;
  reader->SetFileName((folder / "s.vtm").c_str());
  reader->Update();
  auto* blocks = vtkMultiBlockDataSet::SafeDownCast(reader->GetOutput());
  ASSERT_TRUE(blocks && blocks->GetNumberOfBlocks() == 2);
  EXPECT_STREQ(blocks->GetMetaData(0u)->Get(vtkCompositeDataSet::NAME()), "surface");
  auto* grid = vtkStructuredGrid::SafeDownCast(blocks->GetBlock(0));
  auto* points = vtkPolyData::SafeDownCast(blocks->GetBlock(1));
  ASSERT_TRUE(grid && points);
  EXPECT_EQ(grid->GetNumberOfPoints(), 41 * 41);
  ASSERT_EQ(points->GetNumberOfVerts(), 5);
  for (int i = 0; i < 5; ++i)
    expect_same_bits(points->GetPointData()->GetArray("y [m]")->GetTuple1(i),
                     figure.clouds[0].x[static_cast<std::size_t>(i)]);
}

TEST_F(ReadBack, the_same_surface_gives_the_same_bytes) {
  module.export_surface(surface(), folder / "a.vts");
  module.export_surface(surface(), folder / "b.vts");
  EXPECT_EQ(content(folder / "a.vts"), content(folder / "b.vts"));
}

TEST(CapturedErrors, vtk_complains_to_us_and_not_to_the_terminal) {
  testing::internal::CaptureStderr();
  std::string complaint;
  {
    const lunid::figure::CapturedErrors errors;
    EXPECT_EQ(errors.first(), "");
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName("/no/such/file.vtp");
    reader->Update();
    complaint = errors.first();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_NE(complaint.find("/no/such/file.vtp"), std::string::npos) << complaint;
  EXPECT_EQ(complaint.find('\n'), std::string::npos);
}

}  // namespace
