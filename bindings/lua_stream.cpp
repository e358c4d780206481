// Records larger than memory.
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "progress.hpp"
#include "runtime.hpp"
#include "stream.hpp"

namespace lunid::lua {

std::vector<Stream> check_streams(lua_State* L, int index) {
  std::vector<Stream> out;
  check_table(L, index);
  for_each(L, index, [&](lua_Integer) {
    if (const Stream* stream = test<Stream>(L, -1))
      out.push_back(*stream);
    else
      out.push_back(check<Record>(L, -1));
  });
  return out;
}

namespace {

/// Shows how far a pass over the rows is, and ends it after Ctrl-C.
class Watch {
 public:
  Watch(Runtime& runtime, std::string name, double rows) : runtime_(runtime), name_(std::move(name)), rows_(rows) {}

  void operator()(Eigen::Index rows) {
    throw_if_cancelled(runtime_);
    const double done = static_cast<double>(seen_ += rows) / rows_, pass = std::ceil(done);
    log_.show(name_ + ", pass " + std::to_string(static_cast<int>(pass)), done - pass + 1);
  }

 private:
  Runtime& runtime_;
  const std::string name_;
  const double rows_;
  std::atomic<Eigen::Index> seen_{0};
  ProgressLog log_;
};

/// stream(path, {columns =, rate =, interval =, derivative = {kind =, ...}, smooth =})
int open(lua_State* L) {
  const std::string path = check_string(L, 1);
  check_table(L, 2);
  Runtime& host = runtime(L);
  StreamOptions options;
  options.read = file_options(L, 2);
  with_field(L, 2, "derivative", [&] { options.derivative = derivative_method(L, lua_gettop(L)); });
  options.smooth = boolean_field(L, 2, "smooth", false);
  ProgressLog log;
  options.progress = [&](double fraction) {
    throw_if_cancelled(host);
    log.show("look through " + path, fraction);
  };
  const auto watch = std::make_shared<std::unique_ptr<Watch>>();
  options.reading = [watch](Eigen::Index rows) { (**watch)(rows); };
  const ProgressLine line;
  Stream stream = open_stream(path, options);
  *watch = std::make_unique<Watch>(host, path, static_cast<double>(stream.rows()));
  host.note_input(path);
  push<Stream>(L, std::move(stream));
  return 1;
}

int window(lua_State* L) {
  push<Stream>(L, check<Stream>(L, 1).window(check_number(L, 2), check_number(L, 3)));
  return 1;
}

/// stream_range(stream, channel) -> least, largest value
int range(lua_State* L) {
  const Stream& stream = check<Stream>(L, 1);
  const std::string name = check_string(L, 2);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  if (name == "t") {
    low = stream.start(), high = stream.start() + stream.duration();
  } else {
    stream.channel(name);
    const ProgressLine line;
    stream.for_each_block([&](Eigen::Index, const Record& rows) {
      for (const double value : rows[name]) low = std::min(low, value), high = std::max(high, value);
    });
  }
  lua_pushnumber(L, low);
  lua_pushnumber(L, high);
  return 2;
}

/// Fields name, rows, dt, start, duration, channels, warnings, history; or a method.
int get(lua_State* L) {
  const Stream& stream = check<Stream>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "name")
    push_text(L, stream.name());
  else if (key == "rows")
    lua_pushinteger(L, stream.rows());
  else if (key == "dt")
    lua_pushnumber(L, stream.dt());
  else if (key == "start")
    lua_pushnumber(L, stream.start());
  else if (key == "duration")
    lua_pushnumber(L, stream.duration());
  else if (key == "channels")
    push_channels(L, stream.channels());
  else if (key == "warnings")
    push_texts(L, stream.warnings());
  else if (key == "history")
    push_texts(L, stream.history());
  else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1))
      throw InputError(
          "a stream has no '" + key +
          "' (fields: name rows dt start duration channels warnings history; methods: window filter detrend decimate "
          "resample integrate); what needs all rows at once takes a record from lunid.read");
  }
  return 1;
}

/// "stream big.csv: 20000000 rows, 2.5e4 s at 800 Hz; channels F y v* a*"
int to_string(lua_State* L) {
  const Stream& stream = check<Stream>(L, 1);
  char head[128];
  std::snprintf(head, sizeof head, ": %lld rows, %.6g s at %.6g Hz; channels", static_cast<long long>(stream.rows()),
                stream.duration(), 1 / stream.dt());
  std::string text = "stream " + stream.name() + head;
  for (const Channel& channel : stream.channels()) text += " " + channel.name + (channel.derived ? "*" : "");
  for (const std::string& warning : stream.warnings()) text += "\n  warning: " + warning;
  push_text(L, text);
  return 1;
}

}  // namespace

void open_streams(lua_State* L) {
  static constexpr Entry methods[] = {{"window", guarded<window>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<Stream>(L, methods, meta);
  static constexpr Entry functions[] = {{"stream", guarded<open>}, {"stream_range", guarded<range>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
