#include "record/stream.hpp"

#include <algorithm>
#include <cmath>

#include "record/blockwise.hpp"
#include "record/checks.hpp"
#include "record/container.hpp"
#include "record/method_parts.hpp"
#include "record/row_source.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr const char* where = "stream";

const Channel* find(const std::vector<Channel>& channels, std::string_view name) {
  const auto found = std::find_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

}  // namespace

struct Stream::File {
  RowSource::Layout layout;  // with the derived channels
  std::unique_ptr<const RowSource> source;
  std::vector<BlockwiseChannels> derived;
  std::function<void(Index rows)> reading;
};

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
  for (const BlockwiseChannels& derived : file_->derived) reach = std::max(reach, derived.reach);
  // A filter at the end of the record is one-sided over the rows that it has inside.
  const Index from = std::max<Index>(std::min(first_ + first - reach, layout.rows - 2 * reach - 1), 0);
  const Index to = std::min(std::max(first_ + first + count + reach, 2 * reach + 1), layout.rows);
  const std::vector<VectorXd> columns = file_->source->read(from, to - from);
  if (file_->reading) file_->reading(count);
  const Index skip = first_ + first - from;
  std::vector<Channel> channels = layout.channels;
  for (std::size_t i = 0; i < columns.size(); ++i) channels[i].values = columns[i].segment(skip, count);
  for (const BlockwiseChannels& derived : file_->derived) {
    const Eigen::MatrixXd values = derived.values(columns, layout.dt);
    for (std::size_t k = 0; k < derived.places.size(); ++k)
      channels[derived.places[k]].values = values.col(static_cast<Index>(k)).segment(skip, count);
  }
  return {layout.name, layout.t0 + layout.dt * static_cast<double>(first_ + first), layout.dt, std::move(channels)};
}

void Stream::for_each_block(const std::function<void(Index first, const Record& rows)>& visit) const {
  for (Index at = 0; at < count_; at += stream_rows) visit(at, read(at, std::min(stream_rows, count_ - at)));
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
  file->derived = derive_blockwise(*file->source, file->layout, options, part(0.5));
  file->reading = options.reading;
  return Stream(file);
}

}  // namespace lunid
