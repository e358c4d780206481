#include "figure/module/surface_file.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLStructuredGridWriter.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace lunid::figure {
namespace {

std::string array_name(const Axis& axis, const char* fallback) {
  const std::string name = axis.name.empty() ? fallback : axis.name;
  return axis.unit.empty() ? name : name + " [" + axis.unit + "]";
}

/// Points and their three arrays of exact doubles.
class PointTable {
 public:
  explicit PointTable(const SurfaceFigure& figure) {
    points_->SetDataTypeToDouble();
    arrays_[0]->SetName(array_name(figure.x, "x").c_str());
    arrays_[1]->SetName(array_name(figure.y, "y").c_str());
    arrays_[2]->SetName(array_name(figure.z, "z").c_str());
  }

  vtkIdType add(double x, double y, double z) {
    const double values[] = {x, y, z};
    for (std::size_t k = 0; k < 3; ++k) arrays_[k]->InsertNextValue(values[k]);
    // A NaN coordinate would make the bounds of the whole file NaN.
    return points_->InsertNextPoint(x, y, std::isfinite(z) ? z : 0.0);
  }

  void give_to(vtkPointSet& data) {
    data.SetPoints(points_);
    for (const auto& array : arrays_) data.GetPointData()->AddArray(array);
    data.GetPointData()->SetActiveScalars(arrays_[2]->GetName());
  }

 private:
  vtkNew<vtkPoints> points_;
  std::array<vtkNew<vtkDoubleArray>, 3> arrays_;
};

template <class Writer, class Data>
std::string written(Data& data) {
  vtkNew<Writer> writer;
  writer->SetInputData(&data);
  writer->WriteToOutputStringOn();
  writer->SetDataModeToBinary();
  if (writer->Write() != 1 || writer->GetOutputString().empty())
    throw std::runtime_error("the XML writer gave nothing");
  return writer->GetOutputString();
}

void add_grid(PointTable& table, const SurfaceFigure& figure) {
  for (Eigen::Index row = 0; row < figure.surface.rows(); ++row)
    for (Eigen::Index column = 0; column < figure.surface.cols(); ++column)
      table.add(figure.grid_x[static_cast<std::size_t>(column)], figure.grid_y[static_cast<std::size_t>(row)],
                figure.surface(row, column));
}

}  // namespace

std::string surface_as_vts(const SurfaceFigure& figure) {
  vtkNew<vtkStructuredGrid> grid;
  grid->SetDimensions(static_cast<int>(figure.surface.cols()), static_cast<int>(figure.surface.rows()), 1);
  PointTable table(figure);
  add_grid(table, figure);
  table.give_to(*grid);
  for (Eigen::Index row = 0; row < figure.surface.rows(); ++row)
    for (Eigen::Index column = 0; column < figure.surface.cols(); ++column)
      if (!std::isfinite(figure.surface(row, column))) grid->BlankPoint(row * figure.surface.cols() + column);
  return written<vtkXMLStructuredGridWriter>(*grid);
}

std::string surface_as_vtp(const SurfaceFigure& figure) {
  PointTable table(figure);
  add_grid(table, figure);
  const Eigen::MatrixXd& z = figure.surface;
  const auto id = [&](Eigen::Index row, Eigen::Index column) {
    return static_cast<vtkIdType>(row * z.cols() + column);
  };
  vtkNew<vtkCellArray> quads, vertices;
  vtkNew<vtkIntArray> part;
  part->SetName("part");
  // Vertices come before polygons in the order of a vtkPolyData's cells.
  for (std::size_t k = 0; k < figure.clouds.size(); ++k) {
    const Cloud& cloud = figure.clouds[k];
    for (std::size_t i = 0; i < cloud.x.size(); ++i) {
      const vtkIdType vertex = table.add(cloud.x[i], cloud.y[i], cloud.z[i]);
      vertices->InsertNextCell(1, &vertex);
      part->InsertNextValue(static_cast<int>(k) + 1);
    }
  }
  for (Eigen::Index r = 0; r + 1 < z.rows(); ++r)
    for (Eigen::Index c = 0; c + 1 < z.cols(); ++c) {
      if (!std::isfinite(z(r, c) + z(r, c + 1) + z(r + 1, c + 1) + z(r + 1, c))) continue;
      const vtkIdType corners[] = {id(r, c), id(r, c + 1), id(r + 1, c + 1), id(r + 1, c)};
      quads->InsertNextCell(4, corners);
      part->InsertNextValue(0);
    }
  vtkNew<vtkPolyData> data;
  table.give_to(*data);
  data->SetVerts(vertices);
  data->SetPolys(quads);
  data->GetCellData()->AddArray(part);
  return written<vtkXMLPolyDataWriter>(*data);
}

}  // namespace lunid::figure
