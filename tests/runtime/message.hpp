#pragma once
// What an InputError says, for tests of messages.
#include <string>

#include "expr/error.hpp"

namespace lunid {

/// The text of the InputError that f() throws; "no error" when it throws none.
template <class F>
std::string message(F f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace lunid
