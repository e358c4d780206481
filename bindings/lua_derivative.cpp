// What is done to records: derivatives, filters, trends, rates, delays, integrals.
#include "progress.hpp"
#include "record/derive.hpp"
#include "record/stream_treat.hpp"
#include "stream.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

int whole_field(lua_State* L, int index, const char* field, int otherwise) {
  return static_cast<int>(number_field(L, index, field).value_or(otherwise));
}

}  // namespace

DerivativeMethod derivative_method(lua_State* L, int index) {
  const std::string kind = string_field(L, index, "kind").value_or("");
  const auto number = [&](const char* field) { return number_field(L, index, field).value_or(0); };
  const auto whole = [&](const char* field, int otherwise) { return whole_field(L, index, field, otherwise); };
  if (kind == "finite_differences") return FiniteDifferences{whole("accuracy", 0), whole("step", 0)};
  if (kind == "savitzky_golay") return PolynomialWindow{whole("rows", 0), whole("order", 0)};
  if (kind == "fourier") return FourierFilter{number("cutoff")};
  if (kind == "spline")
    return SmoothingSpline{whole("degree", 5),
                           string_field(L, index, "by").value_or("noise") == "noise"
                               ? SmoothingSpline::Choice::noise
                               : SmoothingSpline::Choice::cross_validation,
                           number("weight")};
  if (kind == "total_variation") return TotalVariation{whole("order", 3), number("weight")};
  if (kind == "smoothed_differences")
    return SmoothedDifferences{whole("rows", 0), whole("order", 0), whole("accuracy", 2)};
  if (kind == "kalman") return KalmanSmoother{number("density"), whole("order", 4)};
  throw InputError("derive: no method '" + kind + "'");
}

namespace {

/// derive(record, {method = {kind=, ...}, channels = {...}, from =, smooth =}) -> record
int derive_record(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  check_table(L, 2);
  DeriveOptions options;
  with_field(L, 2, "method", [&] { options.method = derivative_method(L, lua_gettop(L)); });
  options.channels = strings_field(L, 2, "channels");
  options.from = string_field(L, 2, "from").value_or("");
  options.smooth = boolean_field(L, 2, "smooth", false);
  push<Record>(L, derive(record, options));
  return 1;
}

/// treat(a record or a stream) of the first argument, as what it was.
template <class Treat>
int treated(lua_State* L, Treat treat) {
  if (const Stream* stream = test<Stream>(L, 1)) {
    const ProgressLine line;
    push<Stream>(L, treat(*stream));
  } else {
    push<Record>(L, treat(check<Record>(L, 1)));
  }
  return 1;
}

/// filter_record(record or stream, {from =, to =, stop =, order =, channels =}) -> the same
int filter_record(lua_State* L) {
  check_table(L, 2);
  FilterOptions options;
  options.band = {number_field(L, 2, "from").value_or(0), number_field(L, 2, "to").value_or(0),
                  boolean_field(L, 2, "stop", false)};
  options.order = whole_field(L, 2, "order", options.order);
  options.channels = strings_field(L, 2, "channels");
  return treated(L, [&](const auto& record) { return filter(record, options); });
}

/// detrend_record(record or stream, {degree =, channels =}) -> the same
int detrend_record(lua_State* L) {
  check_table(L, 2);
  const int degree = whole_field(L, 2, "degree", 1);
  const std::vector<std::string> channels = strings_field(L, 2, "channels");
  return treated(L, [&](const auto& record) { return detrend(record, degree, channels); });
}

int decimate_record(lua_State* L) {
  const int factor = static_cast<int>(check_integer(L, 2));
  return treated(L, [&](const auto& record) { return decimate(record, factor); });
}

int resample_record(lua_State* L) {
  const double rate = check_number(L, 2);
  return treated(L, [&](const auto& record) { return resample(record, rate); });
}

/// align_record(record, other, {channel =, most =}) -> record, delay, correlation
int align_record(lua_State* L) {
  check_table(L, 3);
  AlignOptions options;
  options.channel = string_field(L, 3, "channel").value_or(options.channel);
  options.most = number_field(L, 3, "most").value_or(0);
  Aligned aligned = align(check<Record>(L, 1), check<Record>(L, 2), options);
  push<Record>(L, std::move(aligned.record));
  lua_pushnumber(L, aligned.delay);
  lua_pushnumber(L, aligned.correlation);
  return 3;
}

/// integrate_record(record or stream, {from =, degree =, below =}) -> the same
int integrate_record(lua_State* L) {
  check_table(L, 2);
  IntegrateOptions options;
  options.from = string_field(L, 2, "from").value_or("");
  options.degree = whole_field(L, 2, "degree", options.degree);
  options.below = number_field(L, 2, "below").value_or(0);
  return treated(L, [&](const auto& record) { return integrate(record, options); });
}

}  // namespace

void open_derivatives(lua_State* L) {
  static constexpr Entry functions[] = {
      {"derive_record", guarded<derive_record>},       {"filter_record", guarded<filter_record>},
      {"detrend_record", guarded<detrend_record>},     {"decimate_record", guarded<decimate_record>},
      {"resample_record", guarded<resample_record>},   {"align_record", guarded<align_record>},
      {"integrate_record", guarded<integrate_record>},
  };
  set_functions(L, functions);
}

}  // namespace lunid::lua
