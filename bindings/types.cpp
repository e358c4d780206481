#include "types.hpp"

namespace lunid::lua {

void open_files(lua_State* L);
void open_expressions(lua_State* L);
void open_lua_functions(lua_State* L);
void open_columns(lua_State* L);
void open_records(lua_State* L);
void open_streams(lua_State* L);
void open_derivatives(lua_State* L);
void open_spectra(lua_State* L);
void open_signals(lua_State* L);
void open_models(lua_State* L);
void open_runs(lua_State* L);
void open_fits(lua_State* L);
void open_responses(lua_State* L);
void open_ensembles(lua_State* L);
void open_regressions(lua_State* L);
void open_curves(lua_State* L);
void open_histories(lua_State* L);
void open_selections(lua_State* L);
void open_surfaces(lua_State* L);
void open_statistics(lua_State* L);
void open_comparisons(lua_State* L);
void open_discoveries(lua_State* L);
void open_stages(lua_State* L);
void open_figures(lua_State* L);
void open_doctor(lua_State* L);

std::span<const Opener> openers() {
  static constexpr Opener all[] = {
      open_files,       open_expressions, open_lua_functions, open_columns,   open_records,
      open_streams,     open_derivatives, open_spectra,       open_signals,   open_models,
      open_runs,        open_fits,        open_responses,     open_ensembles, open_regressions,
      open_curves,      open_histories,   open_selections,    open_surfaces,  open_statistics,
      open_comparisons, open_discoveries, open_stages,        open_figures,   open_doctor};
  return all;
}

}  // namespace lunid::lua
