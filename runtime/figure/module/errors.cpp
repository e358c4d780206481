#include "figure/module/errors.hpp"

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

namespace lunid::figure {
namespace {

class Collector : public vtkOutputWindow {
 public:
  static Collector* New();
  vtkTypeMacro(Collector, vtkOutputWindow);
  void DisplayText(const char*) override {}
  void DisplayWarningText(const char*) override {}
  void DisplayGenericWarningText(const char*) override {}
  void DisplayDebugText(const char*) override {}
  void DisplayErrorText(const char* text) override {
    if (first.empty()) first = text;
  }
  std::string first;
};
vtkStandardNewMacro(Collector);

/// VTK's form is "ERROR: In file.cxx, line 7\nvtkClass (0x...): what happened\n\n"; a reader wants the last
/// part.
std::string what_happened(std::string text) {
  const std::size_t address = text.find("(0x");
  const std::size_t colon = address == std::string::npos ? std::string::npos : text.find("): ", address);
  if (colon != std::string::npos) text = text.substr(colon + 3);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text;
}

}  // namespace

CapturedErrors::CapturedErrors() {
  // VTK's log prints the same complaints a second time, past the output window.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  vtkOutputWindow::SetInstance(vtkNew<Collector>());
}

CapturedErrors::~CapturedErrors() { vtkOutputWindow::SetInstance(nullptr); }

std::string CapturedErrors::first() const {
  const auto* collector = Collector::SafeDownCast(vtkOutputWindow::GetInstance());
  return collector ? what_happened(collector->first) : std::string();
}

}  // namespace lunid::figure
