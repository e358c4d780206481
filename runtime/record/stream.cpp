#include "record/stream.hpp"

#include <algorithm>
#include <cmath>

#include "expr/joined.hpp"
#include "record/blockwise.hpp"
#include "record/checks.hpp"
#include "record/columns.hpp"
#include "record/container.hpp"
#include "record/method_parts.hpp"
#include "record/row_source.hpp"
#include "record/treated_rows.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr const char* where = "stream";

const Channel* find(const std::vector<Channel>& channels, std::string_view name) {
  const auto found = std::find_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

/// A file's rows with what is derived of its channels.
class DerivedRows : public RowSource {
 public:
  DerivedRows(std::unique_ptr<const RowSource> file, const StreamOptions& options, const Progress& progress)
      : file_(std::move(file)), reading_(options.reading) {
    layout_ = file_->layout();
    derived_ = derive_blockwise(*file_, layout_, options, progress);
    constexpr Index least = 3;  // a derivative needs 6 rows or more
    if (!derived_.empty()) reach_ = least;
    for (const BlockwiseChannels& derived : derived_) reach_ = std::max(reach_, derived.reach);
  }

  std::vector<VectorXd> read(Index first, Index count) const override {
    // A filter at the end of the record is one-sided over the rows that it has inside.
    const Index from = std::max<Index>(std::min(first - reach_, layout_.rows - 2 * reach_ - 1), 0);
    const Index to = std::min(std::max(first + count + reach_, 2 * reach_ + 1), layout_.rows);
    const std::vector<VectorXd> columns = file_->read(from, to - from);
    std::vector<VectorXd> out(layout_.channels.size());
    for (std::size_t i = 0; i < columns.size(); ++i) out[i] = columns[i].segment(first - from, count);
    for (const BlockwiseChannels& derived : derived_) {
      const Eigen::MatrixXd values = derived.values(columns, layout_.dt);
      for (std::size_t k = 0; k < derived.places.size(); ++k)
        out[derived.places[k]] = values.col(static_cast<Index>(k)).segment(first - from, count);
    }
    return out;
  }

  void count_read(Index rows) const override {
    if (reading_) reading_(rows);
  }

 private:
  std::unique_ptr<const RowSource> file_;
  std::function<void(Index rows)> reading_;
  std::vector<BlockwiseChannels> derived_;
  Index reach_ = 0;
};

}  // namespace

void for_each_piece(const RowSource& rows,
                    const std::function<void(Index first, const std::vector<VectorXd>& columns)>& visit) {
  const Index all = rows.layout().rows;
  for (Index at = 0; at < all; at += stream_rows) {
    const Index count = std::min(stream_rows, all - at);
    visit(at, rows.read(at, count));
    rows.count_read(count);
  }
}

Stream::Stream(Record record) : record_(std::move(record)), count_(record_->rows()) {}

Stream::Stream(std::shared_ptr<const RowSource> rows) : rows_(std::move(rows)), count_(rows_->layout().rows) {}

const std::string& Stream::name() const { return record_ ? record_->name() : rows_->layout().name; }
double Stream::dt() const { return record_ ? record_->dt() : rows_->layout().dt; }
double Stream::start() const {
  return record_ ? record_->start() : rows_->layout().t0 + rows_->layout().dt * static_cast<double>(first_);
}
const std::vector<Channel>& Stream::channels() const {
  return record_ ? record_->channels() : rows_->layout().channels;
}
const std::vector<std::string>& Stream::warnings() const {
  return record_ ? record_->warnings() : rows_->layout().warnings;
}
const std::vector<std::string>& Stream::history() const {
  return record_ ? record_->history() : rows_->layout().history;
}
bool Stream::has(std::string_view channel) const { return find(channels(), channel) != nullptr; }

const Channel& Stream::channel(std::string_view channel) const {
  if (const Channel* found = find(channels(), channel)) return *found;
  const std::string names = joined(channels(), &Channel::name);
  std::string text =
      "no channel '" + std::string(channel) + "': the " + (record_ ? "record" : "stream") + " has " + names;
  const bool integral = channel == "y" ? has("v") || has("a") : channel == "v" && has("a");
  if (!record_ && integral) text += "; it would be an integral: see stream:integrate";
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
  const RowSource::Layout& layout = rows_->layout();
  std::vector<VectorXd> columns = rows_->read(first_ + first, count);
  rows_->count_read(count);
  std::vector<Channel> channels = layout.channels;
  for (std::size_t i = 0; i < columns.size(); ++i) channels[i].values = std::move(columns[i]);
  return {layout.name, layout.t0 + layout.dt * static_cast<double>(first_ + first), layout.dt, std::move(channels)};
}

std::shared_ptr<const RowSource> Stream::source() const {
  if (first_ == 0 && count_ == rows_->layout().rows) return rows_;
  return part_of(rows_, first_, count_);
}

void Stream::for_each_block(const std::function<void(Index first, const Record& rows)>& visit) const {
  for (Index at = 0; at < count_; at += stream_rows) visit(at, read(at, std::min(stream_rows, count_ - at)));
}

Stream open_stream(const std::string& path, const StreamOptions& options) {
  if (options.read.resample) refuse(where, "resample: a stream is not resampled: see lunid.read");
  const bool container = is_container(path);
  if (!container && (!options.read.interval_name.empty() || !options.read.rate_name.empty()))
    refuse(where, "rate and interval: expected a number for a CSV file, got a name");
  // Two looks: each has half of the progress.
  const auto part = [&](double from) -> Progress {
    if (!options.progress) return {};
    return [&options, from](double fraction) { options.progress(from + fraction / 2); };
  };
  auto file = (container ? open_container_rows : open_csv_rows)(path, options.read, part(0));
  for (const ColumnMap& map : options.read.columns)
    if (constant_of(map) && !find(file->layout().channels, map.channel))
      refuse(where, map.channel + "=" + map.header + ": a stream has the columns of its file, which has no '" +
                        map.header + "': see lunid.read");
  return Stream(std::make_shared<DerivedRows>(std::move(file), options, part(0.5)));
}

}  // namespace lunid
