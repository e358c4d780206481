#include "record/columns.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "expr/joined.hpp"
#include "expr/words.hpp"

namespace lunid {
namespace {

/// A channel of the language, the words that a header may use for it (lower case), its SI units, and a word that it has
/// in files of what turns, where all that have such a word are there.
struct Meaning {
  std::string_view channel;
  std::array<std::string_view, 4> words;
  std::array<std::string_view, 5> units;
  std::string_view turning{};
};
constexpr std::array meanings{
    Meaning{"t", {"time", "zeit"}, {"s"}},
    Meaning{"F", {"force", "load", "kraft"}, {"N", "N m", "V", "A", "Pa"}, "torque"},
    Meaning{"y", {"displacement", "disp", "position", "weg"}, {"m", "rad", "V", "C"}, "angle"},
    Meaning{"v", {"velocity", "vel", "speed", "geschwindigkeit"}, {"m/s", "rad/s", "V", "A"}},
    Meaning{"a", {"acceleration", "acc", "accel", "beschleunigung"}, {"m/s^2", "rad/s^2", "V", "A/s"}},
};

/// 2: the channel's own name or word for word a synonym; 1: a weaker likeness (other case, x for y); 0: none. A name
/// may be abbreviated by a point.
int likeness(const Meaning& meaning, std::string_view name) {
  if (name.size() > 1 && name.ends_with('.')) name.remove_suffix(1);
  if (name == meaning.channel) return 2;
  const std::string word = lower_case(name);
  for (std::string_view synonym : meaning.words)
    if (!synonym.empty() && word == synonym) return 2;
  if (word == lower_case(meaning.channel) || (meaning.channel == "y" && word == "x")) return 1;
  return 0;
}

/// A header such as V [mV] is a voltage, A [A] a current: the letter is its own unit.
bool names_its_unit(const HeaderCell& cell) {
  const auto si = si_unit(cell.unit);
  return si && si->unit == cell.name;
}

bool fits(const Meaning& meaning, std::string_view si) {
  return si.empty() || std::find(meaning.units.begin(), meaning.units.end(), si) != meaning.units.end();
}

/// "m, rad, V"
std::string units_of(const Meaning& meaning) {
  std::string text;
  for (const std::string_view unit : meaning.units)
    if (!unit.empty()) append_item(text, unit);
  return text;
}

const Meaning* meaning_of(std::string_view channel) {
  for (const Meaning& meaning : meanings)
    if (meaning.channel == channel) return &meaning;
  return nullptr;
}

std::string list_headers(const std::vector<HeaderCell>& header) {
  std::string text;
  for (const HeaderCell& cell : header) text += (text.empty() ? "'" : ", '") + cell.text + "'";
  return text;
}

bool is_header(const HeaderCell& cell, const ColumnMap& map) {
  return cell.text == map.header || cell.name == map.header;
}

bool has_header(const std::vector<HeaderCell>& header, const ColumnMap& map) {
  return std::ranges::any_of(header, [&](const HeaderCell& cell) { return is_header(cell, map); });
}

/// The column that `map` asks for.
std::size_t find_header(const std::vector<HeaderCell>& header, const ColumnMap& map, const SourceSpan& where) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (is_header(header[i], map)) return i;
    names.push_back(header[i].name);
  }
  const bool several = map.header.find('=') != std::string::npos;
  throw InputError(
      "no column '" + map.header + "' for channel '" + map.channel + "'; the file has " + list_headers(header) +
          (several ? "; commas separate one column from the next" : did_you_mean(nearest_word(map.header, names), ';')),
      where, Fault::data);
}

/// A column `speed` that turns beside a displacement that does not is that of a shaft, not the velocity.
bool turns(const std::vector<HeaderCell>& header, const HeaderCell& cell) {
  const auto si = si_unit(cell.unit);
  if (lower_case(cell.name) != "speed" || !si || (si->unit != "rad/s" && si->unit != "Hz")) return false;
  return std::none_of(header.begin(), header.end(), [](const HeaderCell& other) {
    const auto unit = si_unit(other.unit);
    return likeness(meanings[2], other.name) > 0 && unit && unit->unit == "rad";
  });
}

bool is_of_rotation(const Meaning& meaning, const HeaderCell& cell) {
  return !meaning.turning.empty() && lower_case(cell.name) == meaning.turning;
}

/// An angle, a torque, a motion in rad: what stands in the header of something that turns.
bool tells_of_rotation(const HeaderCell& cell) {
  const auto is_sign = [&](const Meaning& meaning) {
    const auto si = si_unit(cell.unit);
    return is_of_rotation(meaning, cell) || (likeness(meaning, cell.name) > 0 && si && si->unit.starts_with("rad"));
  };
  return std::ranges::any_of(meanings, is_sign);
}

/// An angle and a torque are y and F of what turns, where two columns tell of that; an angle beside nothing but the
/// time is y of what swings freely.
bool has_rotation(const std::vector<HeaderCell>& header) {
  const auto is_time = [](const HeaderCell& cell) { return likeness(meanings[0], cell.name) > 0; };
  const auto swings = [&](const HeaderCell& cell) { return is_time(cell) || is_of_rotation(meanings[2], cell); };
  return std::ranges::all_of(header, swings) || std::ranges::count_if(header, tells_of_rotation) >= 2;
}

/// The column of a meaning by name, in the header of what turns (`rotation`) or of any; the strongest likeness wins,
/// two of the same strength are an error.
std::optional<std::size_t> find_meaning(const std::vector<HeaderCell>& header, const std::vector<ColumnPlan>& plans,
                                        const Meaning& meaning, bool rotation, const SourceSpan& where) {
  for (int strength : {2, 1}) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < header.size(); ++i) {
      const int likely = rotation && is_of_rotation(meaning, header[i]) ? 1 : likeness(meaning, header[i].name);
      if (plans[i].required || likely != strength) continue;
      if (strength == 1 && names_its_unit(header[i])) continue;
      if (turns(header, header[i])) continue;
      if (found)
        throw InputError("both '" + header[*found].text + "' and '" + header[i].text + "' may be channel '" +
                             std::string(meaning.channel) + "': choose with columns, such as \"" +
                             std::string(meaning.channel) + "=" + header[i].text + "\"",
                         where, Fault::data);
      found = i;
    }
    if (found) return found;
  }
  return std::nullopt;
}

/// "lbf ft" of "lb ft": what is meant by a unit of mass for a channel F or F1 ...; "" where it is none.
std::string as_force(std::string_view channel, std::string unit) {
  if (!channel.starts_with('F') || channel.find_first_not_of("0123456789", 1) != channel.npos) return "";
  for (const std::string_view mass : {"lb", "kg", "oz", "t"}) {
    const std::size_t at = unit.find(mass);
    if (at == unit.npos) continue;
    unit.insert(at + mass.size(), "f");
    const auto si = si_unit(unit);
    return si && fits(*meaning_of("F"), si->unit) ? unit : "";
  }
  return "";
}

/// The channel whose units a channel has: y of y1, yb and y_reference.
const Meaning* kind_of(std::string_view channel) {
  const std::string_view rest = channel.substr(std::min<std::size_t>(1, channel.size()));
  const bool numbered = rest.find_first_not_of("0123456789") == rest.npos;
  return numbered || rest == "b" || rest == "_reference" ? meaning_of(channel.substr(0, 1)) : nullptr;
}

/// A unit in brackets that the header goes on behind.
void warn_of_unit_in_name(const ColumnPlan& plan, std::vector<std::string>& warnings) {
  const std::string& text = plan.header.text;
  for (const char* pair : {"[]", "()"}) {
    const std::size_t open = text.find(pair[0]), close = text.find(pair[1], open + 1);
    if (!plan.required || open == text.npos || close == text.npos) continue;
    const std::string unit(trim(text.substr(open + 1, close - open - 1)));
    if (si_unit(unit))
      warnings.push_back("column '" + text + "': '" + unit + "' within the name is not read as its unit; say it with " +
                         "columns, \"" + plan.channel + "=" + text + " [" + unit + "]\" (--columns)");
  }
}

/// A unit that is said, in the header or by the study, of a column that is a channel is one of its kind.
void set_unit(ColumnPlan& plan, const std::string& unit, const SourceSpan& where, std::vector<std::string>& warnings) {
  if (unit.empty()) {
    warn_of_unit_in_name(plan, warnings);
    if (const Meaning* meaning = meaning_of(plan.channel))
      plan.unit = meaning->units[is_of_rotation(*meaning, plan.header) ? 1 : 0];
    return;
  }
  plan.source_unit = unit;
  const auto si = si_unit(unit);
  const std::string what = "column '" + plan.header.text + "': ";
  if (!si) {
    std::string word = unit_meant(unit);
    if (const std::string force = as_force(plan.channel, word); !force.empty()) word = force;
    const std::string unknown = what + "unknown unit '" + unit + "'", meant = did_you_mean(word);
    if (plan.required)
      throw InputError(unknown + (meant.empty() ? "; known are " + known_units() : meant), where, Fault::data);
    plan.unit = unit;
    warnings.push_back(unknown + ", taken as it is" + meant);
    return;
  }
  plan.factor = si->factor;
  plan.unit = si->unit;
  const std::string no_unit = what + "'" + unit + "' is no unit of channel '" + plan.channel + "'";
  if (const std::string force = as_force(plan.channel, unit); !force.empty())
    throw InputError(no_unit + ", it holds a mass: as a force it is written " + force, where, Fault::data);
  const Meaning* meaning = plan.required ? kind_of(plan.channel) : nullptr;
  if (!meaning || fits(*meaning, si->unit)) return;
  if (meaning->channel == "t") throw InputError(no_unit + ", expected s, ms, us or min", where, Fault::data);
  std::string alike = unit_alike(unit);
  if (const auto other = si_unit(alike); !other || !fits(*meaning, other->unit)) alike.clear();
  std::string text = no_unit + ", expected one of the kind of " + units_of(*meaning) + did_you_mean(alike);
  if (unit == plan.header.unit)  // the file's own word
    text += (alike.empty() ? "; say" : " Say") + std::string(" it with columns, such as \"") + plan.channel + "=" +
            plan.header.name + " [" + (alike.empty() ? std::string(meaning->units[0]) : alike) +
            "]\", or where it is another quantity give it another name, \"other=" + plan.header.name + "\" (--columns)";
  throw InputError(text, where, Fault::data);
}

void check_repeats(const std::vector<HeaderCell>& header, const SourceSpan& where) {
  for (std::size_t i = 0; i < header.size(); ++i)
    for (std::size_t j = i + 1; j < header.size(); ++j)
      if (header[i].name == header[j].name)
        throw InputError("two columns of one name: columns " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
                             " are both '" + header[i].name + "'",
                         where, Fault::data);
}

/// "v_derived" is the channel v, where nothing else is.
void plan_derived(std::vector<ColumnPlan>& plans, const SourceSpan& where, std::vector<std::string>& warnings) {
  for (ColumnPlan& plan : plans) {
    std::string name = plan.header.name;
    if (plan.required || !name.ends_with(derived_ending)) continue;
    name.resize(name.size() - derived_ending.size());
    const bool taken = std::ranges::any_of(plans, [&](const ColumnPlan& other) {
      return other.channel == name || (!other.required && other.header.name == name);
    });
    if (name.empty() || taken) continue;
    plan.channel = name;
    plan.derived = true;
    set_unit(plan, plan.header.unit, where, warnings);
  }
}

/// Columns without a meaning become extra channels under their own names.
void plan_extra(ColumnPlan& plan, const std::vector<ColumnPlan>& plans, const SourceSpan& where,
                std::vector<std::string>& warnings) {
  std::string name = plan.header.name;
  for (const ColumnPlan& other : plans)
    if (other.required && other.channel == name) name = "column " + plan.header.name;
  plan.channel = name;
  set_unit(plan, plan.header.unit, where, warnings);
}

/// A channel that is said to be the same in every row is no column of the file.
void leave_out_constants(const std::vector<HeaderCell>& header, const ReadOptions& options,
                         std::vector<ColumnPlan>& plans, std::vector<std::string>& warnings) {
  for (const ColumnMap& map : options.columns) {
    if (!constant_of(map) || has_header(header, map)) continue;
    for (ColumnPlan& plan : plans) {
      if (plan.channel != map.channel) continue;
      warnings.push_back("left out: the column '" + plan.header.text + "', because " + map.channel + "=" + map.header +
                         " is given");
      plan.channel.clear();
      plan.required = false;
    }
  }
}

/// What to do where no column is the time; those that have a meaning already are not it.
std::string without_time(const std::vector<ColumnPlan>& plans) {
  const auto free = std::find_if(plans.begin(), plans.end(), [](const ColumnPlan& plan) { return !plan.required; });
  return (free == plans.end() ? "; give" : "; name it with columns, such as \"t=" + free->header.text + "\", or give") +
         std::string(" the rows per second: rate = HZ (--rate HZ)");
}

}  // namespace

Channel channel_of(const ColumnPlan& plan) {
  Channel channel;
  channel.name = plan.channel;
  channel.unit = plan.unit;
  channel.source = plan.header.text;
  channel.source_unit = plan.source_unit;
  channel.derived = plan.derived;
  return channel;
}

std::string name_in_files(const Channel& channel) {
  return channel.derived ? channel.name + std::string(derived_ending) : channel.name;
}

std::string_view trim(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return text;
}

HeaderCell split_header(std::string_view text) {
  text = trim(text);
  HeaderCell cell{std::string(text), std::string(text), ""};
  for (const char* pair : {"[]", "()"}) {
    const std::size_t open = text.rfind(pair[0]);
    if (text.empty() || text.back() != pair[1] || open == std::string_view::npos || open == 0) continue;
    cell.name = trim(text.substr(0, open));
    cell.unit = trim(text.substr(open + 1, text.size() - open - 2));
    return cell;
  }
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos || slash == 0) return cell;
  const std::string name(trim(text.substr(0, slash))), unit(trim(text.substr(slash + 1)));
  const bool channel =
      std::any_of(meanings.begin(), meanings.end(), [&](const Meaning& m) { return likeness(m, name) == 2; });
  if (channel || si_unit(unit)) {
    cell.name = name;
    cell.unit = unit;
  }
  return cell;
}

char channel_of_unit(std::string_view unit) {
  char channel = 0;
  for (const Meaning& meaning : meanings) {
    if (unit.empty() || meaning.channel == "t" || !fits(meaning, unit)) continue;
    if (channel) return 0;
    channel = meaning.channel[0];
  }
  return channel;
}

std::vector<ColumnPlan> plan_columns(const std::vector<HeaderCell>& header, const ReadOptions& options,
                                     const SourceSpan& where, std::vector<std::string>& warnings, bool needs_time) {
  check_repeats(header, where);
  std::vector<ColumnPlan> plans(header.size());
  const auto assign = [&](std::size_t i, std::string channel, const std::string& unit) {
    plans[i].channel = std::move(channel);
    plans[i].required = true;
    set_unit(plans[i], unit.empty() ? header[i].unit : unit, where, warnings);
  };
  for (std::size_t i = 0; i < header.size(); ++i) plans[i].header = header[i];
  for (const ColumnMap& map : options.columns) {
    if (constant_of(map) && !has_header(header, map)) continue;
    const std::size_t i = find_header(header, map, where);
    if (plans[i].required)
      throw InputError(
          "column '" + header[i].text + "' is asked for twice, as '" + plans[i].channel + "' and '" + map.channel + "'",
          where, Fault::data);
    assign(i, map.channel, map.unit);
  }
  const bool given = options.interval > 0, rotation = has_rotation(header);
  for (const Meaning& meaning : meanings) {
    const bool mapped = std::any_of(plans.begin(), plans.end(),
                                    [&](const ColumnPlan& p) { return p.required && p.channel == meaning.channel; });
    if (mapped && given && meaning.channel == "t")
      throw InputError("the time column and a rate or interval are both given: expected one of them", where,
                       Fault::data);
    const bool constant = std::ranges::any_of(
        options.columns, [&](const ColumnMap& map) { return map.channel == meaning.channel && constant_of(map); });
    if (mapped || constant) continue;
    const auto i = find_meaning(header, plans, meaning, rotation, where);
    if (!i) continue;
    assign(*i, std::string(meaning.channel), "");
    if (!given || meaning.channel != "t") continue;
    plans[*i].clock = true;
    warnings.push_back("left out: the time '" + header[*i].text + "', because a rate or interval is given");
  }
  if (needs_time && !given &&
      std::none_of(plans.begin(), plans.end(), [](const ColumnPlan& p) { return p.channel == "t"; }))
    throw InputError("no time column: expected a column named 't' or 'time', the file has " + list_headers(header) +
                         without_time(plans),
                     where, Fault::data);
  plan_derived(plans, where, warnings);
  for (ColumnPlan& plan : plans)
    if (!plan.required && !plan.derived) plan_extra(plan, plans, where, warnings);
  for (ColumnPlan& plan : plans)
    if (plan.clock) plan.channel.clear(), plan.required = false;
  leave_out_constants(header, options, plans, warnings);
  return plans;
}

std::string unit_of_force(const Record& record) {
  return record.has("y") && record.channel("y").unit == "rad" ? "N m" : "N";
}

std::optional<double> constant_of(const ColumnMap& map) {
  if (map.channel == "t") return {};
  double value = 0;
  const char* end = map.header.data() + map.header.size();
  const auto [at, error] = std::from_chars(map.header.data(), end, value);
  if (error != std::errc() || at != end || !std::isfinite(value)) return {};
  return value;
}

Record with_constants(const Record& record, const std::vector<ColumnMap>& columns) {
  Record out = record;
  for (const ColumnMap& map : columns) {
    const std::optional<double> value = constant_of(map);
    if (!value || out.has(map.channel)) continue;
    ColumnPlan plan;
    plan.channel = plan.header.text = plan.header.name = map.channel;
    std::vector<std::string> warnings;
    const std::string said = map.channel + "=" + map.header;
    if (*value != 0 && map.unit.empty()) {
      const Meaning* kind = kind_of(map.channel);
      throw InputError("no column '" + map.header + "' for channel '" + map.channel +
                           "': a column is named by its header; a channel that is the same in every row has its unit "
                           "beside the number, as " +
                           said + " [" + std::string(kind ? kind->units[0] : "m") + "]",
                       {record.name()}, Fault::data);
    }
    const bool is_force = map.unit.empty() && map.channel == "F";
    plan.required = true;
    set_unit(plan, is_force ? unit_of_force(record) : map.unit, {record.name()}, warnings);
    Channel channel = channel_of(plan);
    channel.values = Eigen::VectorXd::Constant(record.rows(), *value * plan.factor);
    out = out.with(std::move(channel));
  }
  return out;
}

ColumnMap parse_column(std::string_view channel, std::string_view text) {
  text = trim(text);
  HeaderCell cell;
  const std::size_t end = text.starts_with('"') ? text.find('"', 1) : text.npos;
  if (end != text.npos) {
    cell = split_header("header" + std::string(text.substr(end + 1)));
    cell.name = text.substr(1, end - 1);
  } else {
    cell = split_header(text);
  }
  std::string name(trim(channel));
  for (const Meaning& meaning : meanings)
    if (likeness(meaning, name) == 2) name = meaning.channel;
  return {name, cell.name, cell.unit};
}

std::vector<ColumnMap> parse_columns(std::string_view text) {
  std::vector<ColumnMap> maps;
  for (std::size_t begin = 0; begin <= text.size();) {
    std::size_t end = begin;
    bool quoted = false;
    for (int depth = 0; end < text.size() && (quoted || depth > 0 || text[end] != ','); ++end) {
      quoted = quoted != (text[end] == '"');
      depth += text[end] == '[' || text[end] == '(' ? 1 : text[end] == ']' || text[end] == ')' ? -1 : 0;
    }
    const std::string_view item = trim(text.substr(begin, end - begin));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0 || trim(item.substr(equals + 1)).empty())
      throw InputError(
          "columns: expected channel=header, such as \"t=time,y=disp [mm]\", got '" + std::string(item) + "'", {},
          Fault::usage);
    maps.push_back(parse_column(item.substr(0, equals), item.substr(equals + 1)));
    for (std::size_t i = 0; i + 1 < maps.size(); ++i)
      if (maps[i].channel == maps.back().channel)
        throw InputError("columns: channel '" + maps.back().channel + "' is given twice", {}, Fault::usage);
    begin = end + 1;
  }
  return maps;
}

}  // namespace lunid
