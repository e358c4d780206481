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
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLStructuredGridWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace lunid::figure {
namespace {

std::string array_name(const Axis& axis, const char* fallback) {
  const std::string name = axis.name.empty() ? fallback : axis.name;
  return axis.unit.empty() ? name : name + " [" + axis.unit + "]";
}

/// Points and their three arrays of exact doubles.
class PointTable {
 public:
  explicit PointTable(const Scene& scene) {
    points_->SetDataTypeToDouble();
    arrays_[0]->SetName(array_name(scene.x, "x").c_str());
    arrays_[1]->SetName(array_name(scene.y, "y").c_str());
    arrays_[2]->SetName(array_name(scene.z, "z").c_str());
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

void add_grid(PointTable& table, const Scene& scene) {
  for (Eigen::Index row = 0; row < scene.surface.rows(); ++row)
    for (Eigen::Index column = 0; column < scene.surface.cols(); ++column)
      table.add(scene.grid_x[static_cast<std::size_t>(column)], scene.grid_y[static_cast<std::size_t>(row)],
                scene.surface(row, column));
}

}  // namespace

std::string surface_as_vts(const Scene& scene) {
  vtkNew<vtkStructuredGrid> grid;
  grid->SetDimensions(static_cast<int>(scene.surface.cols()), static_cast<int>(scene.surface.rows()), 1);
  PointTable table(scene);
  add_grid(table, scene);
  table.give_to(*grid);
  for (Eigen::Index row = 0; row < scene.surface.rows(); ++row)
    for (Eigen::Index column = 0; column < scene.surface.cols(); ++column)
      if (!std::isfinite(scene.surface(row, column))) grid->BlankPoint(row * scene.surface.cols() + column);
  return written<vtkXMLStructuredGridWriter>(*grid);
}

namespace {

/// What is drawn: vertices for the points of the clouds, quadrilaterals where all corners have data. Vertices come
/// before polygons in the order of a vtkPolyData's cells.
class CellTable {
 public:
  explicit CellTable(const Scene& scene) : scene_(scene), points_(scene) { part_->SetName("part"); }

  void add_clouds() {
    for (std::size_t k = 0; k < scene_.clouds.size(); ++k) {
      const Cloud& cloud = scene_.clouds[k];
      for (std::size_t i = 0; i < cloud.x.size(); ++i) {
        const vtkIdType vertex = points_.add(cloud.x[i], cloud.y[i], cloud.z[i]);
        vertices_->InsertNextCell(1, &vertex);
        part_->InsertNextValue(static_cast<int>(k) + 1);
      }
    }
  }

  void add_surface_points() { add_grid(points_, scene_); }

  void add_surface_cells() {
    const Eigen::MatrixXd& z = scene_.surface;
    const auto id = [&](Eigen::Index row, Eigen::Index column) {
      return static_cast<vtkIdType>(row * z.cols() + column);
    };
    for (Eigen::Index r = 0; r + 1 < z.rows(); ++r)
      for (Eigen::Index c = 0; c + 1 < z.cols(); ++c) {
        if (!std::isfinite(z(r, c) + z(r, c + 1) + z(r + 1, c + 1) + z(r + 1, c))) continue;
        const vtkIdType corners[] = {id(r, c), id(r, c + 1), id(r + 1, c + 1), id(r + 1, c)};
        quads_->InsertNextCell(4, corners);
        part_->InsertNextValue(0);
      }
  }

  std::string as_vtp() {
    vtkNew<vtkPolyData> data;
    points_.give_to(*data);
    data->SetVerts(vertices_);
    data->SetPolys(quads_);
    data->GetCellData()->AddArray(part_);
    return written<vtkXMLPolyDataWriter>(*data);
  }

  std::string as_vtu() {
    vtkNew<vtkUnstructuredGrid> data;
    points_.give_to(*data);
    vtkNew<vtkCellArray> cells;
    std::vector<int> types;
    for (const auto& [list, type] : {std::pair{vertices_.Get(), VTK_VERTEX}, {quads_.Get(), VTK_QUAD}}) {
      cells->Append(list);
      types.insert(types.end(), static_cast<std::size_t>(list->GetNumberOfCells()), type);
    }
    data->SetCells(types.data(), cells);
    data->GetCellData()->AddArray(part_);
    return written<vtkXMLUnstructuredGridWriter>(*data);
  }

 private:
  const Scene& scene_;
  PointTable points_;
  vtkNew<vtkCellArray> vertices_, quads_;
  vtkNew<vtkIntArray> part_;
};

}  // namespace

std::string surface_as_vtp(const Scene& scene) {
  CellTable table(scene);
  table.add_surface_points();
  table.add_clouds();
  table.add_surface_cells();
  return table.as_vtp();
}

std::string surface_as_vtu(const Scene& scene) {
  CellTable table(scene);
  table.add_surface_points();
  table.add_clouds();
  table.add_surface_cells();
  return table.as_vtu();
}

std::string points_as_vtp(const Scene& scene) {
  CellTable table(scene);
  table.add_clouds();
  return table.as_vtp();
}

}  // namespace lunid::figure
