#pragma once
// What the bindings of discovery and of its stages share.
#include "discover/discover.hpp"
#include "fields.hpp"
#include "progress.hpp"
#include "types.hpp"

namespace lunid::lua {

template <>
struct Bound<Discovery> {
  static constexpr const char* key = "lunid.discovery";
  static constexpr const char* words = "a discovery";
};

/// The list of entries at `index`, each as stdlib/effect.lua made it.
std::vector<Effect> read_catalogue(lua_State* L, int index);
/// The list of records at `index`.
std::vector<Record> read_records(lua_State* L, int index);
/// Options by name; seed, threads and Ctrl-C are those of the run, progress is shown on a terminal.
DiscoverOptions read_discover_options(lua_State* L, int index);

/// The rows of a matrix over (y, v), transposed: one row for each v, as a figure with y along x wants it.
void set_rows(lua_State* L, const char* field, const Eigen::MatrixXd& values);

/// { time =, y =, ..., slow =, plane = }: the maps of a residual, each with its level and its sentence.
void push_maps(lua_State* L, const ResidualMaps& maps);

/// { rivals =, candidates = { { name =, excitation = ... } }, sentence =, text =, json =, decides = }
void push_design(lua_State* L, const ExperimentDesign& design);

}  // namespace lunid::lua
