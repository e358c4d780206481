#include "record/stream_treat.hpp"

#include <algorithm>

#include "record/checks.hpp"
#include "record/treated_rows.hpp"

namespace lunid {
namespace {

std::size_t place_of(const std::vector<Channel>& channels, const std::string& name) {
  const auto found = std::find_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == name; });
  return static_cast<std::size_t>(found - channels.begin());
}

/// The places of these channels, or of all.
Places places_of(const Stream& stream, const std::vector<std::string>& names, std::string_view where) {
  Places places;
  for (const std::string& name : names_or_all(stream.channels(), names, where))
    places.push_back(place_of(stream.channels(), name));
  return places;
}

}  // namespace

Stream filter(const Stream& stream, const FilterOptions& options) {
  if (stream.in_memory()) return filter(stream.record(), options);
  butterworth(options.band, options.order, stream.dt());  // which refuses what no filter is
  return Stream(filtered_rows(stream.source(), places_of(stream, options.channels, "filter"), options));
}

Stream detrend(const Stream& stream, int degree, const std::vector<std::string>& channels) {
  if (stream.in_memory()) return detrend(stream.record(), degree, channels);
  return Stream(detrended_rows(stream.source(), places_of(stream, channels, "detrend"), degree));
}

Stream decimate(const Stream& stream, int factor) {
  if (stream.in_memory()) return decimate(stream.record(), factor);
  return Stream(rated_rows(stream.source(), decimated(stream.rows(), stream.dt(), factor)));
}

Stream resample(const Stream& stream, double rate) {
  if (stream.in_memory()) return resample(stream.record(), rate);
  return Stream(rated_rows(stream.source(), resampled(stream.rows(), stream.dt(), rate)));
}

Stream integrate(const Stream& stream, const IntegrateOptions& options) {
  if (stream.in_memory()) return integrate(stream.record(), options);
  const IntegrationPlan plan = integration_plan(stream.channels(), options);
  std::vector<Channel> channels = stream.channels();
  const std::size_t from = places_of(stream, {plan.from}, "integrate")[0];
  Places places(channels.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = i;
  std::vector<std::string> history = stream.history();
  Rows rows = stream.source();
  std::size_t last = from;
  for (int times = 1; times <= plan.rank; ++times) {
    rows = integrated_rows(rows, last);
    last = rows->layout().channels.size() - 1;
    rows = options.below > 0 ? filtered_rows(rows, {last}, {drift_band(options), drift_order, {}})
                             : detrended_rows(rows, {last}, options.degree + times - 1);
    Channel made = integral_channel(plan, stream.channels()[from], options, times, stream.rows(), stream.dt());
    const std::size_t own = place_of(channels, made.name);
    if (own < channels.size() && !channels[own].derived) continue;  // measured: stays
    history.push_back("integrate: " + made.name + " " + made.derivation);
    if (own == channels.size()) {
      channels.push_back({});
      places.push_back(last);
    }
    channels[own] = made;
    places[own] = last;
  }
  return Stream(arranged_rows(rows, places, std::move(channels), std::move(history)));
}

}  // namespace lunid
