#include "figure/module/display.hpp"

#include <X11/Xlib.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkRenderWindow.h>
#include <vtkVersion.h>

#include <cstdlib>
#include <stdexcept>

namespace lunid::figure {
namespace {

/// A display of this machine. One across a network (ssh -X) can take minutes to answer and has no OpenGL for
/// VTK.
bool is_local(const char* name) { return name && name[0] == ':'; }

}  // namespace

Display::Display() {
  const char* name = std::getenv("DISPLAY");
  if (is_local(name) && open(name)) return;
  own_ = std::make_unique<PrivateDisplay>();
  if (!open(own_->name().c_str()))
    throw std::runtime_error("the private display has no OpenGL 3.2 (apt-get install libgl1-mesa-dri)");
}

Display::~Display() { close(); }

void Display::close() {
  kept_ = nullptr;
  if (connection_) XCloseDisplay(static_cast<::Display*>(connection_));
  connection_ = nullptr;
}

bool Display::open(const char* name) {
  connection_ = XOpenDisplay(name);
  if (!connection_) return false;
  int opcode, event, error;
  const bool glx = XQueryExtension(static_cast<::Display*>(connection_), "GLX", &opcode, &event, &error);
  if (glx && window(8, 8)->SupportsOpenGL()) return true;
  close();
  return false;
}

namespace {

vtkSmartPointer<vtkRenderWindow> new_window(void* connection) {
  auto result = vtkSmartPointer<vtkRenderWindow>::New();
  result->SetDisplayId(connection);
  result->SetOffScreenRendering(1);
  // What is drawn is read from the render buffer: to copy it to a screen that nobody sees takes longer than to draw it.
  if (auto* opengl = vtkOpenGLRenderWindow::SafeDownCast(result)) opengl->SetFrameBlitModeToNoBlit();
  result->SwapBuffersOff();
  result->SetMultiSamples(4);
  result->SetDPI(72);
  return result;
}

}  // namespace

vtkSmartPointer<vtkRenderWindow> Display::window(int width, int height) {
  constexpr double most_kept = 6e6;  // pixels: with four samples and depth some 200 MB
  auto result = kept_ ? kept_ : new_window(connection_);
  result->SetSize(width, height);
  kept_ = static_cast<double>(width) * height > most_kept ? nullptr : result;
  return result;
}

std::string Display::describe() {
  const auto probe = window(8, 8);
  probe->Render();
  std::string gl = "OpenGL";
  if (auto* opengl = vtkOpenGLRenderWindow::SafeDownCast(probe)) {
    int major = 0, minor = 0;
    opengl->GetOpenGLVersion(major, minor);
    gl.append(" ").append(std::to_string(major)).append(".").append(std::to_string(minor));
  }
  std::string text = "VTK ";
  text += vtkVersion::GetVTKVersion();
  text.append(", ").append(gl).append(", ");
  if (own_) return text += "private display (Xvfb)";
  return text.append("display ").append(std::getenv("DISPLAY"));
}

}  // namespace lunid::figure
