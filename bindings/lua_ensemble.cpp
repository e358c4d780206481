// Ensembles: the table of stdlib/ensembles.lua to members, their runs on threads and ranks, and the result.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "expr/external.hpp"
#include "expr/joined.hpp"
#include "runtime.hpp"
#include "sha256.hpp"
#include "statistics/distributions.hpp"
#include "statistics/samples.hpp"
#include "sweep.hpp"

namespace lunid::lua {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Seconds between two writes of what is done.
constexpr double keep_interval = 0.1;

/// Where the members of an ensemble differ: a quantity goes to a parameter of the model, to a symbol of the excitation
/// or of its time base, to a first state, or scales a record ("gain").
class Assembly {
 public:
  Assembly(lua_State* L, const Model& model) : system(model), L_(L) {
    if (model.imposed_motion) throw InputError("ensemble: the motion of this model is imposed: there is no free run");
    read_varied();
    read_signal();
    take_parameters();
    take_first_states();
    take_force();
    check_all_used();
    ensemble.system = &system;
  }
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;

  const System system;
  Ensemble ensemble;
  std::vector<Varied> varied;
  std::string force_text;  ///< what the force depends on, for the key

  template <class Matrix>
  static std::string bytes_of(const Matrix& m) {
    return {reinterpret_cast<const char*>(m.data()), static_cast<std::size_t>(m.size()) * sizeof(double)};
  }

 private:
  void read_varied() {
    const std::vector<std::string> names = strings_field(L_, 2, "names");
    with_field(L_, 2, "values", [&] {
      for_each(L_, -1, [&](lua_Integer i) {
        varied.push_back({names[static_cast<std::size_t>(i - 1)], check_column(L_, -1)});
      });
    });
    members_ = varied.empty() ? 1 : varied[0].values.size();
    used_.resize(varied.size());
  }

  void read_signal() {
    force_ = field_value(L_, 2, "force");
    dt_ = field_value(L_, 2, "dt");
    duration_ = field_value(L_, 2, "duration");
    with_field(L_, 2, "record", [&] { records_.push_back(check<Record>(L_, -1)); });
    with_field(L_, 2, "records", [&] {
      for_each(L_, -1, [&](lua_Integer) { records_.push_back(check<Record>(L_, -1)); });
      made_ = true;
    });
    if (const auto name = string_field(L_, 2, "interpolation")) interpolation_ = interpolation_named(*name);
  }

  /// The values of this name where it is varied, and marks it as used.
  const VectorXd* find(const std::string& name) {
    for (std::size_t i = 0; i < varied.size(); ++i) {
      if (varied[i].name != name) continue;
      used_[i] = 1;
      return &varied[i].values;
    }
    return nullptr;
  }

  void take_parameters() {
    const Model& model = system.model();
    ensemble.theta.resize(system.parameters(), members_);
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      const Parameter& row = model.parameters[i];
      if (const VectorXd* values = find(row.name))
        ensemble.theta.row(static_cast<Index>(i)) = *values;
      else if (std::isnan(row.value))
        throw InputError("ensemble: parameter '" + row.name + "' has no value; give it one, or vary it");
      else
        ensemble.theta.row(static_cast<Index>(i)).setConstant(row.value);
    }
  }

  void take_first_states() {
    const auto& names = system.dynamics().names;
    ensemble.x0.setZero(system.states(), members_);
    const auto& states = system.model().states;
    const int motion = system.states() - static_cast<int>(states.size());
    for (std::size_t i = 0; i < states.size(); ++i)
      ensemble.x0.row(motion + static_cast<Index>(i)).setConstant(states[i].initial);
    with_field(L_, 2, "from", [&] {
      const VectorXd from = check_column(L_, -1);
      if (from.size() > system.states())
        throw InputError("ensemble: from: expected at most " + std::to_string(system.states()) + " values, got " +
                         std::to_string(from.size()));
      for (Index i = 0; i < from.size(); ++i) ensemble.x0.row(i).setConstant(from[i]);
    });
    for (std::size_t i = 0; i < names.size(); ++i)
      if (const VectorXd* values = find(names[i])) ensemble.x0.row(static_cast<Index>(i)) = *values;
  }

  /// The value of a parameter of the excitation for every member: varied, of the model, or as declared.
  VectorXd symbol_values(const Expr& symbol, const Value& in, const char* field) {
    const std::string& name = symbol.name();
    if (symbol.kind() != SymbolKind::parameter)
      throw InputError(std::string("ensemble: ") + field + ": cannot hold '" + name + "', only parameters" +
                       (std::string_view(field) == "excitation" ? " and the time" : ""));
    if (const VectorXd* values = find(name)) return *values;
    const Parameter* row = system.model().find(name);
    if (!row) row = find_declared(in.declared, name);
    if (!row || std::isnan(row->value))
      throw InputError(std::string("ensemble: ") + field + ": parameter '" + name +
                       "' has no value; give it one, or vary it");
    return VectorXd::Constant(members_, row->value);
  }

  /// A number, or an expression of parameters, for every member.
  VectorXd evaluate(const Value& value, const char* field) {
    std::vector<Expr> inputs = symbols(value.expr);
    Eigen::MatrixXd q(static_cast<Index>(inputs.size()), members_);
    for (std::size_t i = 0; i < inputs.size(); ++i)
      q.row(static_cast<Index>(i)) = symbol_values(inputs[i], value, field);
    const Tape tape(std::span(&value.expr, 1), inputs);
    std::vector<double> scratch(static_cast<std::size_t>(tape.registers() + 1));
    VectorXd out(members_);
    for (Index m = 0; m < members_; ++m) tape.run_point(q.col(m).data(), &out[m], scratch.data());
    for (Index m = 0; m < members_; ++m)
      if (!(out[m] > 0) || !std::isfinite(out[m]))
        throw InputError("ensemble: " + std::string(field) + ": member " + std::to_string(m + 1) +
                         ": expected > 0, got " + short_number(out[m]));
    return out;
  }

  static std::string short_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
  }

  void take_force() {
    if (!records_.empty()) return take_records();
    const VectorXd dt = evaluate(dt_, "dt"), duration = evaluate(duration_, "duration");
    const auto rows_of = [&](Index m) { return std::llround(duration[m] / dt[m]) + 1; };
    for (Index m = 0; m < members_; ++m)
      if (rows_of(m) != rows_of(0))
        throw InputError(
            "ensemble: duration: all members need the same number of rows, duration / dt + 1: member 1 has " +
            std::to_string(rows_of(0)) + ", member " + std::to_string(m + 1) + " has " + std::to_string(rows_of(m)));
    if (rows_of(0) < 2) throw InputError("ensemble: duration: expected >= dt");
    Pool& pool = *runtime(L_).pool();
    const Expr t = pool.channel("t");
    std::vector<Expr> inputs{t};
    std::vector<VectorXd> rows;
    for (const Expr& symbol : symbols(force_.expr)) {
      if (symbol == t) continue;
      rows.push_back(symbol_values(symbol, force_, "excitation"));
      inputs.push_back(symbol);
    }
    Eigen::MatrixXd q(static_cast<Index>(rows.size()), members_);
    for (std::size_t i = 0; i < rows.size(); ++i) q.row(static_cast<Index>(i)) = rows[i];
    std::vector<Expr> outputs(system.inputs().size(), pool.constant(0));  // it is the force of the first coordinate
    if (!outputs.empty()) outputs[0] = force_.expr;
    force_text = to_text(force_.expr) + bytes_of(q) + bytes_of(dt) + std::to_string(rows_of(0));
    ensemble.force = MemberForce::of(system.inputs(), TimeTape(outputs, inputs), std::move(q), 0, dt, rows_of(0));
  }

  void take_records() {
    const VectorXd* gain = find("gain");
    const Index rows = records_[0].rows();
    std::vector<Excitation> forces;  // made here: their formulas add to the pool
    for (const Record& record : records_) {
      if (record.rows() != rows)
        throw InputError("ensemble: excitation: all members need the same number of rows: the first has " +
                         std::to_string(rows) + ", another " + std::to_string(record.rows()));
      const auto force = record["F"];
      forces.push_back(excitation_of(
          record, interpolation_ ? interpolation_ : read_between(system.model(), record, system.inputs())));
      force_text += std::to_string(record.start()) + " " + std::to_string(record.dt()) + " " +
                    to_string(forces.back().interpolation()) +
                    std::string(reinterpret_cast<const char*>(force.data()), force.size_bytes());
    }
    if (!made_ && !gain) {
      ensemble.force = MemberForce::of(forces[0]);
      return;
    }
    if (gain) force_text += bytes_of(*gain);
    const auto make = [made = made_, forces, scale = gain ? *gain : VectorXd()](Index m) {
      const Excitation& force = forces[made ? static_cast<std::size_t>(m) : 0];
      return Excitations(scale.size() == 0 ? force : force.scaled(scale[m]));
    };
    ensemble.force = MemberForce::of(rows, make);
  }

  /// What varies must be something; where a function of the case made the records, it may be its own.
  void check_all_used() const {
    if (made_) return;
    for (std::size_t i = 0; i < varied.size(); ++i) {
      if (used_[i]) continue;
      std::vector<std::string> known;
      for (const Parameter& row : system.model().parameters) known.push_back(row.name);
      if (force_.expr.valid())
        for (const Expr& symbol : symbols(force_.expr, SymbolKind::parameter)) known.push_back(symbol.name());
      if (!records_.empty()) known.push_back("gain");
      for (const std::string& state : system.dynamics().names) known.push_back(state);
      const std::string words = joined(known);
      const std::string near = nearest_word(varied[i].name, known);
      throw InputError("ensemble: nothing is called '" + varied[i].name + "'" +
                       (near.empty() ? " (to vary: " + words + ")" : did_you_mean(near)));
    }
  }

  lua_State* L_;
  Index members_ = 1;
  bool made_ = false;  ///< a record for each member
  std::vector<char> used_;
  Value force_, dt_, duration_;
  std::vector<Record> records_;
  std::optional<Interpolation> interpolation_;
};

/// 64 digits of all that the members depend on. `functions`: what external functions come from.
std::string key_of(const Assembly& a, const EnsembleOptions& options, int substeps, const std::string& functions) {
  std::string text = LUNID_VERSION "\n" + a.system.model().equation() + "\n" + a.force_text;
  text += Assembly::bytes_of(a.ensemble.theta) + Assembly::bytes_of(a.ensemble.x0);
  for (const EnsembleOutput& output : options.outputs) text += output.name + " ";
  return sha256(text + std::to_string(options.settled) + " " + std::to_string(substeps) + functions);
}

/// "\r 37 %  ensemble: 370 of 1000 members, about 12 s left" on a terminal.
class Progress {
 public:
  Progress(Index done, Index members) : shown_(isatty(STDERR_FILENO)), before_(done), members_(members) {}
  ~Progress() {
    if (shown_) std::fputs("\r\033[K", stderr);
  }
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  void show(Index done) const {
    if (!shown_ || done == before_) return;
    const double left = seconds() * static_cast<double>(members_ - done) / static_cast<double>(done - before_);
    std::fprintf(stderr, "\r\033[K%3.0f %%  ensemble: %lld of %lld members, about %.0f s left",
                 100 * static_cast<double>(done) / static_cast<double>(members_), static_cast<long long>(done),
                 static_cast<long long>(members_), std::ceil(left));
  }

 private:
  bool shown_;
  Index before_, members_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The files in which the ranks of an earlier start may have kept members.
std::vector<std::string> partial_paths(const std::string& base) {
  namespace fs = std::filesystem;
  std::vector<std::string> paths;
  std::error_code ignored;
  const fs::path folder = fs::path(base).parent_path();
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored))
    if (entry.path().filename().string().starts_with(fs::path(base).filename().string() + "."))
      paths.push_back(entry.path().string());
  return paths;
}

/// Every rank runs its share and learns the others'.
void share(const Ranks& ranks, std::span<const Index> mine, EnsembleResult& result) {
  std::string packed;
  const auto put = [&](const void* data, std::size_t size) { packed.append(static_cast<const char*>(data), size); };
  for (const Index member : mine) {
    if (!result.done[static_cast<std::size_t>(member)]) continue;
    const std::string& cause = result.cause[static_cast<std::size_t>(member)];
    const std::size_t length = cause.size();
    const Eigen::RowVectorXd values = result.values.row(member);
    put(&member, sizeof member);
    put(&result.stopped_at[member], sizeof(double));
    put(values.data(), sizeof(double) * static_cast<std::size_t>(values.size()));
    put(&length, sizeof length);
    put(cause.data(), length);
    for (const Eigen::MatrixXd& signal : result.trajectories)
      put(signal.col(member).data(), sizeof(double) * static_cast<std::size_t>(signal.rows()));
  }
  for (const std::string& part : ranks.gather(packed)) {
    const char* at = part.data();
    const auto get = [&](void* data, std::size_t size) {
      std::copy_n(at, size, static_cast<char*>(data));
      at += size;
    };
    while (at != part.data() + part.size()) {
      Index member = 0;
      std::size_t length = 0;
      Eigen::RowVectorXd values(result.values.cols());
      get(&member, sizeof member);
      get(&result.stopped_at[member], sizeof(double));
      get(values.data(), sizeof(double) * static_cast<std::size_t>(values.size()));
      get(&length, sizeof length);
      std::string cause(length, '\0');
      get(cause.data(), length);
      for (Eigen::MatrixXd& signal : result.trajectories)
        get(signal.col(member).data(), sizeof(double) * static_cast<std::size_t>(signal.rows()));
      result.values.row(member) = values;
      result.cause[static_cast<std::size_t>(member)] = std::move(cause);
      result.done[static_cast<std::size_t>(member)] = 1;
    }
  }
}

EnsembleOptions read_options(lua_State* L, const System& system) {
  EnsembleOptions options;
  for (const std::string& name : strings_field(L, 2, "outputs")) {
    try {
      options.outputs.push_back(output_from(name, system));
    } catch (const InputError& error) {
      throw InputError("ensemble: " + error.message());
    }
  }
  if (options.outputs.empty())
    for (int i = 0; i < system.degrees(); ++i)
      for (const char* summary : {"rms_", "max_"})
        options.outputs.push_back(
            output_from(summary + system.dynamics().names[static_cast<std::size_t>(2 * i)], system));
  options.substeps = static_cast<int>(number_field(L, 2, "substeps").value_or(0));
  options.settled = number_field(L, 2, "settled").value_or(0);
  options.trajectories = boolean_field(L, 2, "keep_trajectories", false);
  options.threads = runtime(L).threads;
  options.cancelled = &runtime(L).cancelled();
  return options;
}

/// The part of a rank: whole runs of members, so that its lanes are full.
std::vector<Index> share_of(Index members, const Ranks& ranks) {
  const Index from = members * ranks.rank() / ranks.size(), to = members * (ranks.rank() + 1) / ranks.size();
  std::vector<Index> mine(static_cast<std::size_t>(to - from));
  std::iota(mine.begin(), mine.end(), from);
  return mine;
}

/// After Ctrl-C: what is done, and that it is not lost.
void say_kept(const EnsembleResult& result, PartialFile* partial) {
  if (partial) partial->flush();
  std::fprintf(stderr, "ensemble: %lld of %lld members are done%s\n", static_cast<long long>(result.finished()),
               static_cast<long long>(result.values.rows()),
               partial ? " and kept; the same study continues from them" : "");
}

/// ensemble(model, {names=, values=, record= | records= | force=, dt=, duration=, interpolation=, from=, outputs=,
/// settled=, substeps=, keep_trajectories=, partial=, functions=}) -> sweep
int ensemble(lua_State* L) {
  check_table(L, 2);
  Assembly assembly(L, check<Model>(L, 1));
  const Ranks& ranks = runtime(L).ranks();
  const ExternalWatch externals(*runtime(L).pool());
  EnsembleOptions options = read_options(L, assembly.system);
  Sweep sweep;
  sweep.varied = assembly.varied;
  sweep.rows = assembly.ensemble.force.rows();
  sweep.result = prepare_ensemble(assembly.ensemble, options);
  EnsembleResult& result = sweep.result;

  const bool external = !runtime(L).pool()->functions().empty();
  const std::string origin = external ? string_field(L, 2, "functions").value_or("") : "";
  const std::string key =
      key_of(assembly, options, result.substeps, external ? origin + std::to_string(runtime(L).seed) : "");
  const auto folder = string_field(L, 2, "partial");
  const std::string base = folder ? *folder + key.substr(0, 12) : "";
  const std::vector<std::string> earlier =
      folder && !options.trajectories ? partial_paths(base) : std::vector<std::string>{};
  for (const std::string& path : earlier) PartialFile::read(path, key, result);
  sweep.kept_from_before = result.finished();
  ranks.gather("");  // all have read before one writes

  const std::vector<Index> mine = share_of(assembly.ensemble.members(), ranks);
  PartialFile partial(base + "." + std::to_string(ranks.rank()), key);
  std::vector<Index> known;
  for (const Index member : mine)
    if (result.done[static_cast<std::size_t>(member)]) known.push_back(member);
  partial.add(result, known);
  {
    const Progress progress(static_cast<Index>(known.size()), static_cast<Index>(mine.size()));
    auto done = static_cast<Index>(known.size());
    double written = 0;
    options.finished = [&](std::span<const Index> members) {
      done += static_cast<Index>(members.size());
      if (ranks.rank() == 0) progress.show(done);
      if (!folder || options.trajectories) return;
      partial.add(result, members);
      if (progress.seconds() - written < keep_interval) return;
      partial.flush();
      written = progress.seconds();
    };
    run_members(assembly.ensemble, options, mine, result);
    sweep.seconds = progress.seconds();
  }
  if (runtime(L).cancelled()) say_kept(result, folder && !options.trajectories ? &partial : nullptr);
  throw_if_cancelled(runtime(L));
  share(ranks, mine, result);
  if (folder && ranks.rank() == 0)
    for (const std::string& path : partial_paths(base)) std::filesystem::remove(path);
  sweep.notes = externals.notes();
  push<Sweep>(L, std::move(sweep));
  return 1;
}

/// join_ranks(): under mpirun, the study runs on all ranks together; only the first one speaks.
int join_ranks(lua_State* L) {
  if (!Ranks::launched()) return 0;
  Ranks& ranks = runtime(L).ranks();
  ranks.open();
  if (ranks.rank() > 0 && !std::freopen("/dev/null", "w", stdout)) throw InputError("ranks: cannot open /dev/null");
  return 0;
}

int rank(lua_State* L) {
  lua_pushinteger(L, runtime(L).ranks().rank());
  return 1;
}

/// draw(method, count, seed, {{kind=, a, b}, ...}) -> a column for each
int draw(lua_State* L) {
  const Sampling sampling = sampling_from(check_string(L, 1));
  check_table(L, 4);
  const auto dimensions = static_cast<int>(lua_rawlen(L, 4));
  const Eigen::MatrixXd unit =
      unit_samples(sampling, check_integer(L, 2), dimensions,
                   lua_isnoneornil(L, 3) ? runtime(L).seed : static_cast<std::uint64_t>(check_integer(L, 3)));
  lua_newtable(L);
  const int results = lua_gettop(L);
  for_each(L, 4, [&](lua_Integer i) {
    const std::string kind = string_field(L, -1, "kind").value_or("");
    const double a = number_field(L, -1, "a").value_or(0), b = number_field(L, -1, "b").value_or(0);
    VectorXd values = unit.row(i - 1);
    for (double& u : values) {
      if (kind == "normal")
        u = a + b * normal_quantile(u);
      else if (kind == "log_uniform")
        u = std::exp(std::log(a) + u * (std::log(b) - std::log(a)));
      else
        u = a + u * (b - a);
    }
    push_column(L, values);
    lua_rawseti(L, results, i);
  });
  return 1;
}

std::vector<std::string> names_of(const Sweep& sweep) {
  std::vector<std::string> names;
  for (const Varied& v : sweep.varied) names.push_back(v.name);
  names.insert(names.end(), sweep.result.outputs.begin(), sweep.result.outputs.end());
  names.emplace_back("stopped_at");
  return names;
}

VectorXd column_of(const Sweep& sweep, const std::string& name) {
  for (const Varied& v : sweep.varied)
    if (v.name == name) return v.values;
  for (std::size_t j = 0; j < sweep.result.outputs.size(); ++j)
    if (sweep.result.outputs[j] == name) return sweep.result.values.col(static_cast<Index>(j));
  if (name == "stopped_at") return sweep.result.stopped_at;
  std::string words;
  for (const std::string& known : names_of(sweep)) words += (words.empty() ? "" : " ") + known;
  throw InputError("a sweep has no column '" + name + "'; it has " + words);
}

int column(lua_State* L) {
  push_column(L, column_of(check<Sweep>(L, 1), check_string(L, 2)));
  return 1;
}

Index check_member(lua_State* L, const Sweep& sweep) {
  const long long member = check_integer(L, 2);
  if (member < 1 || member > sweep.members())
    throw InputError("member: expected 1 to " + std::to_string(sweep.members()) + ", got " + std::to_string(member));
  return static_cast<Index>(member - 1);
}

/// sweep:trajectory(member, "y") -> column
int trajectory(lua_State* L) {
  const Sweep& sweep = check<Sweep>(L, 1);
  const Index member = check_member(L, sweep);
  const std::string name = check_string(L, 3);
  if (sweep.result.trajectories.empty())
    throw InputError("the sweep has no trajectories; ask for keep = 'trajectories'");
  std::string words;
  for (std::size_t s = 0; s < sweep.result.signals.size(); ++s) {
    words += (words.empty() ? "" : " ") + sweep.result.signals[s];
    if (sweep.result.signals[s] != name) continue;
    push_column(L, sweep.result.trajectories[s].col(member));
    return 1;
  }
  throw InputError("the sweep kept no trajectory '" + name + "'; it kept " + words);
}

/// sweep:cause(member) -> why it stopped early, or nil
int cause(lua_State* L) {
  const Sweep& sweep = check<Sweep>(L, 1);
  const std::string& text = sweep.result.cause[static_cast<std::size_t>(check_member(L, sweep))];
  if (text.empty())
    lua_pushnil(L);
  else
    push_text(L, text);
  return 1;
}

/// Fields members, rows, stopped, substeps, error, seconds, names; or a method.
int get(lua_State* L) {
  const Sweep& sweep = check<Sweep>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "members")
    lua_pushinteger(L, sweep.members());
  else if (key == "rows")
    lua_pushinteger(L, sweep.rows);
  else if (key == "stopped")
    lua_pushinteger(L, sweep.result.stopped());
  else if (key == "substeps")
    lua_pushinteger(L, sweep.result.substeps);
  else if (key == "error")
    lua_pushnumber(L, sweep.result.change);
  else if (key == "seconds")
    lua_pushnumber(L, sweep.seconds);
  else if (key == "continued")
    lua_pushinteger(L, sweep.kept_from_before);
  else if (key == "names") {
    lua_newtable(L);
    lua_Integer i = 0;
    for (const std::string& name : names_of(sweep)) {
      push_text(L, name);
      lua_rawseti(L, -2, ++i);
    }
  } else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1))
      throw InputError("a sweep has no '" + key +
                       "' (fields: members rows stopped substeps error seconds continued names; methods: column "
                       "trajectory cause save)");
  }
  return 1;
}

/// What came out, in a few lines; without the time that it took, so that the same run prints the same.
int to_string(lua_State* L) {
  const Sweep& sweep = check<Sweep>(L, 1);
  const EnsembleResult& result = sweep.result;
  char line[256];
  std::snprintf(line, sizeof line, "sweep of %lld members, %lld rows each, by %s",
                static_cast<long long>(sweep.members()), static_cast<long long>(sweep.rows),
                fixed_solver_name(result.substeps).c_str());
  std::string text = line;
  if (result.stopped() > 0) text += "; " + std::to_string(result.stopped()) + " stopped early";
  const auto range = [&](const std::string& name, const VectorXd& values) {
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (const double value : values) {
      if (!(value == value)) continue;
      least = std::min(least, value);
      greatest = std::max(greatest, value);
    }
    if (least > greatest) return;
    std::snprintf(line, sizeof line, "\n  %-12s %.6g to %.6g", name.c_str(), least, greatest);
    text += line;
  };
  for (const Varied& v : sweep.varied) range(v.name, v.values);
  for (std::size_t j = 0; j < result.outputs.size(); ++j)
    range(result.outputs[j], result.values.col(static_cast<Index>(j)));
  for (const std::string& note : sweep.notes) text += "\n  note: " + note;
  push_text(L, text);
  return 1;
}

}  // namespace

void open_ensembles(lua_State* L) {
  static constexpr Entry methods[] = {
      {"column", guarded<column>}, {"trajectory", guarded<trajectory>}, {"cause", guarded<cause>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<Sweep>(L, methods, meta);
  static constexpr Entry functions[] = {{"ensemble", guarded<ensemble>},
                                        {"draw", guarded<draw>},
                                        {"join_ranks", guarded<join_ranks>},
                                        {"rank", guarded<rank>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
