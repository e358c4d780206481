// Files, the process and JSON text, for the standard library: what a run writes, and how a command ends.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "record/atomic_file.hpp"
#include "runtime.hpp"
#include "sha256.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what, const std::string& path, const std::error_code& code) {
  throw InputError("cannot " + what + " '" + path + "': " + code.message(), {}, Fault::data);
}

int read_text(lua_State* L) {
  const std::string path = check_string(L, 1);
  std::error_code code;
  if (!fs::exists(path, code)) throw InputError("no such file: '" + path + "'", {}, Fault::data);
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path, code)) throw InputError("cannot read '" + path + "'", {}, Fault::data);
  push_text(L, std::string{std::istreambuf_iterator<char>(in), {}});
  return 1;
}

int write_text(lua_State* L) {
  write_file_atomically(check_string(L, 1), check_string(L, 2));
  return 0;
}

/// "file", "directory" or nil.
int kind_of(lua_State* L) {
  std::error_code code;
  const auto status = fs::status(check_string(L, 1), code);
  if (!fs::exists(status)) return 0;
  push_text(L, fs::is_directory(status) ? "directory" : "file");
  return 1;
}

/// All files below a directory, relative to it, sorted.
int list_files(lua_State* L) {
  const fs::path root = check_string(L, 1);
  std::vector<std::string> names;
  std::error_code code;
  for (auto it = fs::recursive_directory_iterator(root, code); !code && it != fs::recursive_directory_iterator();
       it.increment(code)) {
    std::error_code unknown;
    if (!it->is_directory(unknown)) names.push_back(it->path().lexically_relative(root).string());
  }
  if (code) fail("list", root.string(), code);
  std::sort(names.begin(), names.end());
  push_json(L, names);
  return 1;
}

/// Does a directory hold nothing? Looks at no more than its first entry.
int is_empty_directory(lua_State* L) {
  const fs::path root = check_string(L, 1);
  std::error_code code;
  const fs::directory_iterator it(root, code);
  if (code) fail("list", root.string(), code);
  lua_pushboolean(L, it == fs::directory_iterator());
  return 1;
}

int make_directories(lua_State* L) {
  const std::string path = check_string(L, 1);
  std::error_code code;
  fs::create_directories(path, code);
  if (code) fail("make the directory", path, code);
  return 0;
}

int rename_file(lua_State* L) {
  const std::string from = check_string(L, 1), to = check_string(L, 2);
  std::error_code code;
  fs::rename(from, to, code);
  if (code) fail("write", to, code);
  return 0;
}

/// Removes a file, or a directory and all below it.
int remove_all(lua_State* L) {
  const std::string path = check_string(L, 1);
  std::error_code code;
  fs::remove_all(path, code);
  if (code) fail("remove", path, code);
  return 0;
}

int parent_of(lua_State* L) {
  push_text(L, fs::path(check_string(L, 1)).parent_path().string());
  return 1;
}

int hash_of(lua_State* L) {
  push_text(L, sha256_of_file(check_string(L, 1)));
  return 1;
}

int inputs(lua_State* L) {
  auto list = nlohmann::json::array();
  for (const auto& input : runtime(L).inputs()) list.push_back({{"path", input.path}, {"sha256", input.sha256}});
  push_json(L, list);
  return 1;
}

int note_input(lua_State* L) {
  runtime(L).note_input(check_string(L, 1));
  return 0;
}

int json_text(lua_State* L) {
  push_text(L, to_json(L, 1).dump(1) + "\n");
  return 1;
}

int parse_json(lua_State* L) {
  const std::string text = check_string(L, 1);
  const auto value = nlohmann::json::parse(text, nullptr, false);
  if (value.is_discarded()) throw InputError("this is not JSON", {}, Fault::data);
  push_json(L, value);
  return 1;
}

int base64(lua_State* L) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string bytes = check_string(L, 1);
  std::string text;
  text.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t j) -> std::uint32_t {
      return j < bytes.size() ? static_cast<unsigned char>(bytes[j]) : 0;
    };
    const std::uint32_t word = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
    for (int k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[word >> (18 - 6 * k) & 63];
  }
  push_text(L, text);
  return 1;
}

int process_id(lua_State* L) {
  lua_pushinteger(L, getpid());
  return 1;
}

/// Raises an error of a kind: raise(message, "study" | "usage" | "data" | "interrupted"), with the user's file and
/// line when there is one.
int raise(lua_State* L) {
  const std::string kind = check_string(L, 2);
  const Fault fault = kind == "usage"         ? Fault::usage
                      : kind == "data"        ? Fault::data
                      : kind == "interrupted" ? Fault::interrupted
                                              : Fault::study;
  throw InputError(check_string(L, 1), {}, fault);
}

/// Raises `text` as it is, with the kind of fault that `cause`, an earlier message, had.
int reraise(lua_State* L) {
  const std::string text = check_string(L, 1);
  runtime(L).note_fault(text, runtime(L).fault_of(check_string(L, 2)));
  lua_settop(L, 1);
  return lua_error(L);
}

/// "study.lua:14" of the user's innermost frame, or "".
int place(lua_State* L) {
  std::string position = user_position(L);
  if (position.size() > 2) position.resize(position.size() - 2);
  push_text(L, position);
  return 1;
}

/// Was Ctrl-C pressed? Forgets it, so that what was done can be put away.
int take_interrupt(lua_State* L) {
  lua_sethook(L, nullptr, 0, 0);
  lua_pushboolean(L, runtime(L).cancelled().exchange(false));
  return 1;
}

/// nearest(value, words): the one of the words that is nearest to a word, or nil; nil for what is no word.
int nearest(lua_State* L) {
  check_table(L, 2);
  if (lua_type(L, 1) != LUA_TSTRING) return 0;
  std::vector<std::string> words;
  for_each(L, 2, [&](lua_Integer) { words.push_back(check_string(L, -1)); });
  const std::string word = nearest_word(check_string(L, 1), words);
  if (word.empty()) return 0;
  push_text(L, word);
  return 1;
}

/// did_you_mean(near): what a message adds for a word that is near, or nil for nil and "".
int did_you_mean_text(lua_State* L) {
  const std::string text = did_you_mean(lua_isnoneornil(L, 1) ? "" : check_string(L, 1));
  if (text.empty()) return 0;
  push_text(L, text);
  return 1;
}

/// What a value is, in words: "a record", "the string 'x'".
int describe_value(lua_State* L) {
  push_text(L, describe(L, 1));
  return 1;
}

/// add_method(key, name, function): a method of a bound type that the standard library writes.
int add_method(lua_State* L) {
  const std::string key = check_string(L, 1), name = check_string(L, 2);
  if (luaL_getmetatable(L, key.c_str()) != LUA_TTABLE) throw InputError("no bound type '" + key + "'");
  lua_getfield(L, -1, "__methods");
  lua_pushvalue(L, 3);
  lua_setfield(L, -2, name.c_str());
  return 0;
}

int set_run(lua_State* L) {
  runtime(L).seed = static_cast<std::uint64_t>(check_integer(L, 1));
  runtime(L).threads = static_cast<int>(check_integer(L, 2));
  return 0;
}

}  // namespace

void open_files(lua_State* L) {
  static constexpr Entry functions[] = {
      {"read_text", guarded<read_text>},
      {"write_text", guarded<write_text>},
      {"kind_of", guarded<kind_of>},
      {"list_files", guarded<list_files>},
      {"is_empty_directory", guarded<is_empty_directory>},
      {"make_directories", guarded<make_directories>},
      {"rename", guarded<rename_file>},
      {"remove_all", guarded<remove_all>},
      {"parent_of", guarded<parent_of>},
      {"hash_of", guarded<hash_of>},
      {"inputs", guarded<inputs>},
      {"note_input", guarded<note_input>},
      {"json_text", guarded<json_text>},
      {"parse_json", guarded<parse_json>},
      {"base64", guarded<base64>},
      {"process_id", guarded<process_id>},
      {"raise", guarded<raise>},
      {"reraise", guarded<reraise>},
      {"place", guarded<place>},
      {"take_interrupt", guarded<take_interrupt>},
      {"nearest", guarded<nearest>},
      {"did_you_mean", guarded<did_you_mean_text>},
      {"describe", guarded<describe_value>},
      {"add_method", guarded<add_method>},
      {"set_run", guarded<set_run>},
  };
  set_functions(L, functions);
  push_text(L, runtime(L).library().string());
  lua_setfield(L, -2, "library");
  push_text(L, LUNID_VERSION);
  lua_setfield(L, -2, "version");
}

}  // namespace lunid::lua
