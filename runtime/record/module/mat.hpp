#pragma once
// Handles of matio that close themselves.
#include <matio.h>

#include <memory>

namespace lunid::container {

struct CloseMat {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
using OpenMat = std::unique_ptr<mat_t, CloseMat>;

struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Owned = std::unique_ptr<matvar_t, FreeVariable>;

}  // namespace lunid::container
