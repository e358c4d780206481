#include "figure/module/surface_scene.hpp"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkGlyph3D.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace lunid::figure {
namespace {

class SceneBuilder {
 public:
  SceneBuilder(vtkRenderer& renderer, const SurfaceFigure& figure, const SurfaceView& view)
      : renderer_(renderer),
        figure_(figure),
        view_(view),
        rows_(figure.surface.rows()),
        columns_(figure.surface.cols()) {}

  void build() {
    place_points();
    surface();
    mesh();
    for (const Cloud& cloud : figure_.clouds) points(cloud);
    camera();
  }

 private:
  vtkIdType id(Eigen::Index row, Eigen::Index column) const { return row * columns_ + column; }

  bool shown(Eigen::Index row, Eigen::Index column) const {
    return view_.holds(figure_.grid_x[static_cast<std::size_t>(column)], figure_.grid_y[static_cast<std::size_t>(row)],
                       figure_.surface(row, column));
  }

  /// One point for each grid point, also where there is no data: no cell uses those.
  void place_points() {
    points_->SetDataTypeToDouble();
    values_->SetName("z");
    for (Eigen::Index row = 0; row < rows_; ++row)
      for (Eigen::Index column = 0; column < columns_; ++column) {
        const double z = shown(row, column) ? figure_.surface(row, column) : view_.z.range.low;
        const Vector p = view_.in_box(figure_.grid_x[static_cast<std::size_t>(column)],
                                      figure_.grid_y[static_cast<std::size_t>(row)], z);
        points_->InsertNextPoint(p.data());
        values_->InsertNextValue(colour_position(view_.colour, figure_.diverging, z));
      }
  }

  void surface() {
    vtkNew<vtkCellArray> cells;
    for (Eigen::Index r = 0; r + 1 < rows_; ++r)
      for (Eigen::Index c = 0; c + 1 < columns_; ++c) {
        if (!(shown(r, c) && shown(r, c + 1) && shown(r + 1, c + 1) && shown(r + 1, c))) continue;
        const vtkIdType corners[] = {id(r, c), id(r, c + 1), id(r + 1, c + 1), id(r + 1, c)};
        cells->InsertNextCell(4, corners);
      }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points_);
    data->SetPolys(cells);
    data->GetPointData()->SetScalars(values_);
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(data);
    normals->SplittingOff();
    vtkNew<vtkLookupTable> colours;
    colours->SetNumberOfTableValues(256);
    for (int i = 0; i < 256; ++i) {
      const Colour c = map_colour(i / 255.0, figure_.diverging);
      colours->SetTableValue(i, c.red / 255.0, c.green / 255.0, c.blue / 255.0);
    }
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(normals->GetOutputPort());
    mapper->SetLookupTable(colours);
    mapper->SetScalarRange(0.0, 1.0);
    mapper->InterpolateScalarsBeforeMappingOn();
    // Mesh lines lie in the surface and must win against it.
    mapper->SetResolveCoincidentTopologyToPolygonOffset();
    mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(1.0, 1.0);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetAmbient(0.68);
    actor->GetProperty()->SetDiffuse(0.38);
    actor->GetProperty()->SetSpecular(0.0);
    renderer_.AddActor(actor);
  }

  /// Grid lines on the surface, about twenty each way, that show its shape.
  void mesh() {
    vtkNew<vtkCellArray> lines;
    const auto filled = [&](Eigen::Index r, Eigen::Index c) {
      return r >= 0 && c >= 0 && r + 1 < rows_ && c + 1 < columns_ && shown(r, c) && shown(r + 1, c) &&
             shown(r, c + 1) && shown(r + 1, c + 1);
    };
    // Between two cells, or at the border of one: a line without a cell beside it would hang in the air.
    const auto add = [&](Eigen::Index r0, Eigen::Index c0, Eigen::Index r1, Eigen::Index c1) {
      const bool along_row = r0 == r1;
      if (!filled(r0, c0) && !filled(r0 - (along_row ? 1 : 0), c0 - (along_row ? 0 : 1))) return;
      const vtkIdType ends[] = {id(r0, c0), id(r1, c1)};
      lines->InsertNextCell(2, ends);
    };
    const Eigen::Index row_step = std::max<Eigen::Index>(1, rows_ / 20),
                       column_step = std::max<Eigen::Index>(1, columns_ / 20);
    for (Eigen::Index r = 0; r < rows_; r += row_step)
      for (Eigen::Index c = 0; c + 1 < columns_; ++c) add(r, c, r, c + 1);
    for (Eigen::Index c = 0; c < columns_; c += column_step)
      for (Eigen::Index r = 0; r + 1 < rows_; ++r) add(r, c, r + 1, c);
    vtkNew<vtkPolyData> data;
    data->SetPoints(points_);
    data->SetLines(lines);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    mapper->ScalarVisibilityOff();
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(0.1, 0.1, 0.1);
    actor->GetProperty()->SetOpacity(0.35);
    actor->GetProperty()->SetLineWidth(static_cast<float>(0.5 * figure_.size.dpi / 72.0));
    actor->GetProperty()->LightingOff();
    renderer_.AddActor(actor);
  }

  /// Spheres; of points so close that they look like one, only the first.
  void points(const Cloud& cloud) {
    constexpr double cell = 1.0 / 200.0;
    vtkNew<vtkPoints> centres;
    centres->SetDataTypeToDouble();
    std::unordered_set<std::uint64_t> taken;
    for (std::size_t i = 0; i < cloud.x.size(); ++i) {
      if (!view_.holds(cloud.x[i], cloud.y[i], cloud.z[i])) continue;
      const Vector p = view_.in_box(cloud.x[i], cloud.y[i], cloud.z[i]);
      std::uint64_t key = 0;
      for (const double value : p) key = key << 20 | static_cast<std::uint64_t>((value + 1.0) / cell);
      if (taken.insert(key).second) centres->InsertNextPoint(p.data());
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(centres);
    vtkNew<vtkSphereSource> sphere;
    sphere->SetRadius(0.0065);
    sphere->SetThetaResolution(10);
    sphere->SetPhiResolution(8);
    vtkNew<vtkGlyph3D> glyphs;
    glyphs->SetInputData(data);
    glyphs->SetSourceConnection(sphere->GetOutputPort());
    glyphs->ScalingOff();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(glyphs->GetOutputPort());
    mapper->ScalarVisibilityOff();
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    const Colour c = role_colour(cloud.role, figure_.theme);
    actor->GetProperty()->SetColor(c.red / 255.0, c.green / 255.0, c.blue / 255.0);
    renderer_.AddActor(actor);
  }

  void camera() {
    // The focus lies where the paper's middle is.
    const double dx = (0.5 * view_.extent.x - view_.centre.x) / view_.scale;
    const double dy = (0.5 * view_.extent.y - view_.centre.y) / view_.scale;
    Vector focus, eye;
    for (std::size_t k = 0; k < 3; ++k) {
      focus[k] = dx * view_.right[k] + dy * view_.up[k];
      eye[k] = focus[k] + 5.0 * view_.toward[k];
    }
    vtkCamera* camera = renderer_.GetActiveCamera();
    camera->ParallelProjectionOn();
    camera->SetFocalPoint(focus.data());
    camera->SetPosition(eye.data());
    camera->SetViewUp(view_.up.data());
    camera->SetParallelScale(0.5 * view_.extent.y / view_.scale);
    camera->SetClippingRange(1.0, 10.0);
  }

  vtkRenderer& renderer_;
  const SurfaceFigure& figure_;
  const SurfaceView& view_;
  Eigen::Index rows_;
  Eigen::Index columns_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkDoubleArray> values_;
};

}  // namespace

void add_surface(vtkRenderer& renderer, const SurfaceFigure& figure, const SurfaceView& view) {
  SceneBuilder(renderer, figure, view).build();
}

}  // namespace lunid::figure
