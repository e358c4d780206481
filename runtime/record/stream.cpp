#include "record/stream.hpp"

#include <algorithm>
#include <cmath>

#include "record/checks.hpp"
#include "record/container.hpp"
#include "record/method_parts.hpp"
#include "record/motion.hpp"
#include "record/noise_sum.hpp"
#include "record/row_source.hpp"
#include "record/savitzky_golay.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

std::span<const double> span_of(const VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

const Channel* find(const std::vector<Channel>& channels, std::string_view name) {
  const auto found = std::find_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

}  // namespace

Stream::Stream(Record record) : record_(std::move(record)), count_(record_->rows()) {}

Stream::Stream(std::shared_ptr<const File> file) : file_(std::move(file)), count_(file_->layout.rows) {}

const std::string& Stream::name() const { return record_ ? record_->name() : file_->layout.name; }
double Stream::dt() const { return record_ ? record_->dt() : file_->layout.dt; }
double Stream::start() const {
  return record_ ? record_->start() : file_->layout.t0 + file_->layout.dt * static_cast<double>(first_);
}
const std::vector<Channel>& Stream::channels() const { return record_ ? record_->channels() : file_->layout.channels; }
const std::vector<std::string>& Stream::warnings() const {
  return record_ ? record_->warnings() : file_->layout.warnings;
}
bool Stream::has(std::string_view channel) const { return find(channels(), channel) != nullptr; }

const Channel& Stream::channel(std::string_view channel) const {
  if (const Channel* found = find(channels(), channel)) return *found;
  std::string names;
  for (const Channel& c : channels()) names += (names.empty() ? "" : ", ") + c.name;
  std::string text =
      "no channel '" + std::string(channel) + "': the " + (record_ ? "record" : "stream") + " has " + names;
  const bool integral = channel == "y" ? has("v") || has("a") : channel == "v" && has("a");
  if (!record_ && integral) text += "; it would be an integral, which needs the whole record: see lunid.read";
  throw InputError(text, {name()}, Fault::data);
}

Stream Stream::window(double from, double to) const {
  if (record_) return record_->window(from, to);
  const auto [first, count] = rows_of_window(name(), start(), dt(), count_, from, to);
  Stream part = *this;
  part.first_ += first;
  part.count_ = count;
  return part;
}

Record Stream::read(Index first, Index count) const {
  if (record_) return record_->slice(first, count);
  const RowSource::Layout& layout = file_->layout;
  constexpr Index least = 3;  // a derivative needs 6 rows or more
  Index reach = file_->derived.empty() ? 0 : least;
  for (const Derived& derived : file_->derived) reach = std::max(reach, derived.reach);
  // A filter at the end of the record is one-sided over the rows that it has inside.
  const Index from = std::max<Index>(std::min(first_ + first - reach, layout.rows - 2 * reach - 1), 0);
  const Index to = std::min(std::max(first_ + first + count + reach, 2 * reach + 1), layout.rows);
  const std::vector<VectorXd> columns = file_->source->read(from, to - from);
  if (file_->reading) file_->reading(count);
  const Index skip = first_ + first - from;
  std::vector<Channel> channels = layout.channels;
  for (std::size_t i = 0; i < columns.size(); ++i) channels[i].values = columns[i].segment(skip, count);
  std::size_t next = columns.size();
  for (const Derived& derived : file_->derived) {
    const Channel& source = layout.channels[derived.from];
    channels[derived.in_place_of.value_or(next)].values =
        differentiate(span_of(columns[derived.from]), layout.dt, source.noise, derived.derivative, derived.method)
            .values.segment(skip, count);
    next += !derived.in_place_of;
  }
  return {layout.name, layout.t0 + layout.dt * static_cast<double>(first_ + first), layout.dt, std::move(channels)};
}

void Stream::for_each_block(const std::function<void(Index first, const Record& rows)>& visit) const {
  for (Index at = 0; at < count_; at += stream_rows) visit(at, read(at, std::min(stream_rows, count_ - at)));
}

namespace {

constexpr const char* where = "stream";

/// What the second look at a channel finds.
struct ChannelSums {
  explicit ChannelSums(Index rows, bool motion) : noise(rows) {
    if (motion) spectrum.emplace(rows, DerivativeError::segment_length(rows));
  }
  NoiseSum noise;
  std::optional<WelchSum> spectrum;
};

/// Finds the noise of each channel, and the spectra of the motion's.
std::vector<std::optional<Spectrum>> look_again(const RowSource& source, RowSource::Layout& layout,
                                                const Progress& progress) {
  std::vector<ChannelSums> sums;
  for (const Channel& channel : layout.channels) sums.emplace_back(layout.rows, channel.name.find_first_of("yva") == 0);
  for (Index at = 0; at < layout.rows; at += stream_rows) {
    const std::vector<VectorXd> columns = source.read(at, std::min(stream_rows, layout.rows - at));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      sums[i].noise.add(span_of(columns[i]));
      if (sums[i].spectrum) sums[i].spectrum->add(span_of(columns[i]));
    }
    if (progress) progress(static_cast<double>(at) / static_cast<double>(layout.rows));
  }
  std::vector<std::optional<Spectrum>> spectra;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    layout.channels[i].noise = sums[i].noise.level();
    spectra.push_back(sums[i].spectrum ? std::optional(sums[i].spectrum->spectrum()) : std::nullopt);
  }
  return spectra;
}

/// The method with nothing left to choose, and the rows that it needs on either side.
std::pair<DerivativeMethod, Index> chosen(const DerivativeMethod& method, const Spectrum& spectrum, double noise,
                                          int derivative, Index rows) {
  if (const auto* differences = std::get_if<FiniteDifferences>(&method)) {
    if (!differences->accuracy || !differences->step)
      refuse(where,
             "derivative: finite_differences: expected accuracy and step: from the noise they need the whole record");
    // One-sided differences at the ends of the record reach as far as twice the central ones.
    return {method, static_cast<Index>(derivative + differences->accuracy) * differences->step};
  }
  const auto* window = std::get_if<PolynomialWindow>(&method);
  if (!window)
    refuse(where, "derivative: expected savitzky_golay or finite_differences, which need few rows at a time, got " +
                      name_of(method) + ", which needs the whole record: see lunid.read");
  if (window->rows) return {PolynomialWindow{window->rows, window->order ? window->order : 3}, window->rows / 2};
  if (window->order) refuse(where, "derivative: savitzky_golay: expected rows beside order, or neither");
  const SavitzkyGolay filter = choose_savitzky_golay(DerivativeError(spectrum, noise, derivative), rows, derivative);
  return {PolynomialWindow{2 * filter.half_width + 1, filter.order}, filter.half_width};
}

}  // namespace

void Stream::derive(File& file, const StreamOptions& options) {
  RowSource::Layout& layout = file.layout;
  const auto spectra = look_again(*file.source, layout, options.progress);
  const std::size_t measured = layout.channels.size();
  if (options.smooth && !std::holds_alternative<PolynomialWindow>(options.derivative))
    refuse(where, "smooth: expected the derivative savitzky_golay, got " + name_of(options.derivative));
  const auto add = [&](std::size_t from, int rank, int derivative, const std::string& name,
                       std::optional<std::size_t> in_place_of) {
    const Channel source = layout.channels[from];
    const auto [method, reach] = chosen(options.derivative, *spectra[from], source.noise, derivative, layout.rows);
    // What it leaves of the noise, and its words: of any signal that is long enough.
    const VectorXd any = VectorXd::LinSpaced(std::max<Index>(2 * reach + 1, 8), 0, 1);
    const Derivative tried = differentiate(span_of(any), layout.dt, source.noise, derivative, method);
    Channel channel = in_place_of ? source : Channel{};
    channel.name = name;
    channel.unit = in_place_of ? source.unit : motion_unit(source.unit, rank);
    channel.noise = tried.noise;
    channel.derived = !in_place_of;
    channel.derivation = (in_place_of ? "smoothed by " : "of " + source.name + " by ") + tried.how;
    file.derived.push_back({from, derivative, method, reach, in_place_of});
    if (in_place_of)
      layout.channels[*in_place_of] = channel;
    else
      layout.channels.push_back(channel);
  };
  std::vector<std::string> suffixes;
  for (std::size_t i = 0; i < measured; ++i) {
    const std::string name = layout.channels[i].name, suffix = name.substr(1);
    const bool own = suffix.find_first_not_of("0123456789") == std::string::npos || suffix == "b";
    if (name.find_first_of("yva") == 0 && own && std::find(suffixes.begin(), suffixes.end(), suffix) == suffixes.end())
      suffixes.push_back(suffix);
  }
  for (const std::string& suffix : suffixes) {
    const auto index = [&](char rank) -> std::optional<std::size_t> {
      const Channel* found = find(layout.channels, rank + suffix);
      return found ? std::optional(static_cast<std::size_t>(found - layout.channels.data())) : std::nullopt;
    };
    const auto y = index('y'), v = index('v'), a = index('a');
    if (y && !v) add(*y, 1, 1, "v" + suffix, {});
    if (!a && (y || v)) add(v ? *v : *y, 2, v ? 1 : 2, "a" + suffix, {});
    if (!options.smooth) continue;
    for (const auto& each : {y, v, a})
      if (each) add(*each, 0, 0, layout.channels[*each].name, each);
  }
}

Stream open_stream(const std::string& path, const StreamOptions& options) {
  if (options.read.resample) refuse(where, "resample: a stream is not resampled: see lunid.read");
  auto file = std::make_shared<Stream::File>();
  const bool container = is_container(path);
  if (!container && (!options.read.interval_name.empty() || !options.read.rate_name.empty()))
    refuse(where, "rate and interval: expected a number for a CSV file, got a name");
  // Two looks: each has half of the progress.
  const auto part = [&](double from) -> Progress {
    if (!options.progress) return {};
    return [&options, from](double fraction) { options.progress(from + fraction / 2); };
  };
  file->source = (container ? open_container_rows : open_csv_rows)(path, options.read, part(0), file->layout);
  StreamOptions second = options;
  second.progress = part(0.5);
  Stream::derive(*file, second);
  file->reading = options.reading;
  return Stream(file);
}

}  // namespace lunid
