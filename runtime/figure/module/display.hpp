#pragma once
// Where VTK may draw. VTK without a display crashes: nothing of it that draws is called before this has
// answered.
#include <vtkSmartPointer.h>

#include <memory>
#include <string>

#include "figure/module/private_display.hpp"

class vtkRenderWindow;

namespace lunid::figure {

/// An open connection to an X server with OpenGL 3.2: this machine's display where DISPLAY names one that
/// answers, else a private one.
class Display {
 public:
  /// Throws std::runtime_error that says what is missing.
  Display();
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// The window off the screen, empty, of `width` by `height` pixels, one point of text being one pixel. It is one and
  /// the same for all figures, because a new one compiles its shaders anew; a large one is not kept, nor its memory.
  vtkSmartPointer<vtkRenderWindow> window(int width, int height);

  /// Versions of VTK and OpenGL and where the display is, in one line.
  std::string describe();

 private:
  bool open(const char* name);
  void close();
  std::unique_ptr<PrivateDisplay> own_;
  void* connection_ = nullptr;
  vtkSmartPointer<vtkRenderWindow> kept_;
};

}  // namespace lunid::figure
