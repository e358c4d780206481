#include "surface/module/delaunay.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "expr/error.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace lunid::detail {
namespace {

/// Qhull's messages, which it writes to a file.
class Messages {
 public:
  Messages() : file_(open_memstream(&text_, &size_)) {}
  ~Messages() {
    std::fclose(file_);
    std::free(text_);
  }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;
  std::FILE* file() { return file_; }
  std::string first_line() {
    std::fflush(file_);
    const std::string all(text_, size_);
    return all.substr(0, all.find('\n'));
  }

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* file_;
};

/// Qhull's state; it leaves errors by longjmp to a place inside its own calls, past no frame of ours.
struct Hull {
  qhT state;
  explicit Hull(std::FILE* messages) { qh_zero(&state, messages); }
  ~Hull() {
    int left = 0, total = 0;
    qh_freeqhull(&state, !qh_ALL);
    qh_memfreeshort(&state, &left, &total);
  }
};

}  // namespace

std::vector<std::array<int, 3>> delaunay(const Eigen::Matrix2Xd& points) {
  Messages messages;
  Hull hull(messages.file());
  std::vector<double> coordinates(points.data(), points.data() + points.size());
  char command[] = "qhull d Qt Qbb Qc Qz";  // triangulated, scaled, with a point at infinity for points on a circle
  const int code = qh_new_qhull(&hull.state, 2, static_cast<int>(points.cols()), coordinates.data(), False, command,
                                nullptr, messages.file());
  if (code != 0) throw InputError("surface: triangulation: " + messages.first_line(), {}, Fault::data);
  std::vector<std::array<int, 3>> triangles;
  qhT* qh = &hull.state;  // the name that Qhull's loops expect
  facetT* facet;
  vertexT *vertex, **vertexp;
  FORALLfacets {
    if (facet->upperdelaunay) continue;
    std::array<int, 3> corners{};
    std::size_t k = 0;
    FOREACHvertex_(facet->vertices) {
      if (k < 3) corners[k++] = qh_pointid(qh, vertex->point);
    }
    std::sort(corners.begin(), corners.end());
    if (k == 3) triangles.push_back(corners);
  }
  return triangles;
}

}  // namespace lunid::detail
