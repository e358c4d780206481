// What a record looks like over frequency and slow time, as tables of columns and numbers.
#include <cmath>
#include <numbers>

#include "fields.hpp"
#include "record/checks.hpp"
#include "record/spectra.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

void set_whole(lua_State* L, const char* name, Index value) {
  lua_pushinteger(L, value);
  lua_setfield(L, -2, name);
}

Index length_field(lua_State* L, const char* field) {
  return static_cast<Index>(number_field(L, 2, field).value_or(0));
}

/// The channel of the options at index 2, without rows that are no numbers and not constant.
std::span<const double> signal_field(lua_State* L, const char* field, const char* where, Index rows = 16) {
  return varying(check<Record>(L, 1), string_field(L, 2, field).value_or(""), where, rows);
}
double noise_of(lua_State* L) { return check<Record>(L, 1).channel(string_field(L, 2, "channel").value_or("")).noise; }
double dt_of(lua_State* L) { return check<Record>(L, 1).dt(); }
VectorXd from_start(lua_State* L, const VectorXd& time) { return time.array() + check<Record>(L, 1).start(); }

/// record_spectrum(record, {channel =, length =}) -> {frequency, density, low, high, segments, length}
int record_spectrum(lua_State* L) {
  const PowerSpectrum s = power_spectrum(signal_field(L, "channel", "spectrum"), dt_of(L), length_field(L, "length"));
  lua_newtable(L);
  set_column(L, "frequency", s.frequency);
  set_column(L, "density", s.density);
  set_column(L, "low", s.low);
  set_column(L, "high", s.high);
  set_whole(L, "segments", s.segments);
  set_whole(L, "length", s.length);
  return 1;
}

/// record_transfer(record, {input =, output =, estimator = "h1" | "h2", length =})
int record_transfer(lua_State* L) {
  const TransferFunction t = transfer_function(
      signal_field(L, "input", "transfer"), signal_field(L, "output", "transfer"), dt_of(L), length_field(L, "length"));
  const Eigen::VectorXcd& h = string_field(L, 2, "estimator").value_or("h1") == "h2" ? t.h2 : t.h1;
  const VectorXd magnitude = h.cwiseAbs(), margin = 1.96 * t.error;
  lua_newtable(L);
  set_column(L, "frequency", t.frequency);
  set_column(L, "real", h.real());
  set_column(L, "imaginary", h.imag());
  set_column(L, "magnitude", magnitude);
  set_column(L, "phase", h.cwiseArg());
  set_column(L, "coherence", t.coherence);
  set_column(L, "magnitude_low", magnitude.cwiseProduct((1 - margin.array()).max(0).matrix()));
  set_column(L, "magnitude_high", magnitude.cwiseProduct((1 + margin.array()).matrix()));
  set_column(L, "phase_std", t.error.cwiseMin(std::numbers::pi));
  set_number(L, "averages", t.averages);
  set_number(L, "chance", t.chance);
  set_whole(L, "segments", t.segments);
  set_whole(L, "length", t.length);
  return 1;
}

/// record_spectrogram(record, {channel =, length =, hop =}) -> {time, frequency, ridge, densities = {column, ...}}
int record_spectrogram(lua_State* L) {
  const Spectrogram s = spectrogram(signal_field(L, "channel", "spectrogram"), dt_of(L), length_field(L, "length"),
                                    length_field(L, "hop"));
  lua_newtable(L);
  set_column(L, "time", from_start(L, s.time));
  set_column(L, "frequency", s.frequency);
  set_column(L, "ridge", s.ridge);
  lua_createtable(L, static_cast<int>(s.density.cols()), 0);
  for (Index i = 0; i < s.density.cols(); ++i) {
    push_column(L, s.density.col(i));
    lua_rawseti(L, -2, i + 1);
  }
  lua_setfield(L, -2, "densities");
  return 1;
}

/// record_envelope(record, {channel =}) -> {time, amplitude, frequency, phase}
int record_envelope(lua_State* L) {
  const Envelope e = envelope(signal_field(L, "channel", "envelope"), dt_of(L), noise_of(L));
  lua_newtable(L);
  set_column(L, "time", from_start(L, VectorXd::LinSpaced(e.amplitude.size(), 0, check<Record>(L, 1).duration())));
  set_column(L, "amplitude", e.amplitude);
  set_column(L, "frequency", e.frequency);
  set_column(L, "phase", e.phase);
  return 1;
}

/// record_cycles(record, {channel =}) -> {time, period, frequency, amplitude, mean}
int record_cycles(lua_State* L) {
  const std::vector<Cycle> list = cycles(signal_field(L, "channel", "cycles"), dt_of(L), noise_of(L));
  const auto column = [&](auto value) {
    return VectorXd::NullaryExpr(static_cast<Index>(list.size()),
                                 [&](Index i) { return value(list[static_cast<std::size_t>(i)]); })
        .eval();
  };
  lua_newtable(L);
  set_column(L, "time", from_start(L, column([](const Cycle& c) { return c.time; })));
  set_column(L, "period", column([](const Cycle& c) { return c.period; }));
  set_column(L, "frequency", column([](const Cycle& c) { return 1 / c.period; }));
  set_column(L, "amplitude", column([](const Cycle& c) { return c.amplitude; }));
  set_column(L, "mean", column([](const Cycle& c) { return c.mean; }));
  return 1;
}

/// record_noise(record, {channel =}) -> {white, robust, outliers, exponent, exponent_std, background, frequency,
/// density}
int record_noise(lua_State* L) {
  const NoiseReport r = noise_report(signal_field(L, "channel", "noise"), dt_of(L));
  lua_newtable(L);
  set_number(L, "white", r.white);
  set_number(L, "robust", r.robust);
  set_whole(L, "outliers", r.outliers);
  set_number(L, "exponent", r.exponent);
  set_number(L, "exponent_std", r.exponent_std);
  set_number(L, "background", r.background);
  set_column(L, "frequency", r.frequency);
  set_column(L, "density", r.density);
  return 1;
}

/// record_summary(record) -> {text =, channels = {{name, min, max, mean, std, noise, missing, held}, ...}}
int record_summary(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  lua_newtable(L);
  push_text(L, describe(record));
  lua_setfield(L, -2, "text");
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Channel& channel : record.channels()) {
    const ChannelSummary s = summary(record[channel.name]);
    lua_newtable(L);
    push_text(L, channel.name);
    lua_setfield(L, -2, "name");
    push_text(L, channel.unit);
    lua_setfield(L, -2, "unit");
    set_number(L, "min", s.least);
    set_number(L, "max", s.most);
    set_number(L, "mean", s.mean);
    set_number(L, "std", s.std);
    set_number(L, "noise", channel.noise);
    set_whole(L, "missing", s.missing);
    set_whole(L, "held", s.held);
    lua_pushvalue(L, -1);
    lua_setfield(L, -3, channel.name.c_str());
    lua_rawseti(L, -2, ++i);
  }
  lua_setfield(L, -2, "channels");
  return 1;
}

}  // namespace

void open_spectra(lua_State* L) {
  static constexpr Entry functions[] = {
      {"record_spectrum", guarded<record_spectrum>},       {"record_transfer", guarded<record_transfer>},
      {"record_spectrogram", guarded<record_spectrogram>}, {"record_envelope", guarded<record_envelope>},
      {"record_cycles", guarded<record_cycles>},           {"record_noise", guarded<record_noise>},
      {"record_summary", guarded<record_summary>},
  };
  set_functions(L, functions);
}

}  // namespace lunid::lua
