#pragma once
// Shared libraries of Lunid's own, opened at first use because what they link takes longer to load than most studies.
#include <string>

namespace lunid {

struct ModuleFile {
  const char* who;       ///< begins an error: "figures"
  const char* what;      ///< names it in an error: "the drawing module"
  const char* file;      ///< "liblunid_figure.so"
  const char* variable;  ///< of the environment, that may name another place; nullptr: none
  const char* symbol;    ///< what is wanted of it
  bool for_all = false;  ///< its symbols are offered to libraries that it opens itself (plug-ins of MPI)
};

/// The address of `symbol`. Looks at `given` when it is not empty, else at what the variable names, else beside the
/// executable and in ../lib/lunid/ from there. The library is never unloaded. Throws InputError: not there (with the
/// places looked at), not loadable, no such symbol.
void* open_module(const ModuleFile& module, const std::string& given = {});

}  // namespace lunid
