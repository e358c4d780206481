// The rows of a CSV file that is larger than memory.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "record/csv_table.hpp"
#include "record/row_source.hpp"
#include "record/time_base.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t piece_bytes = 1 << 16;

/// A file that many may read at once.
class File {
 public:
  explicit File(const std::string& path) : path_(path), descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) fail(errno == ENOENT ? "no such file" : "cannot read: " + std::string(std::strerror(errno)));
    struct stat info {};
    if (::fstat(descriptor_, &info) == 0) size_ = static_cast<std::size_t>(info.st_size);
  }
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::size_t size() const { return size_; }
  /// Bytes [first, first + count), fewer at the end of the file.
  std::string read(std::size_t first, std::size_t count) const {
    std::string text(std::min(count, size_ - std::min(first, size_)), '\0');
    for (std::size_t used = 0; used < text.size();) {
      const ssize_t got =
          ::pread(descriptor_, text.data() + used, text.size() - used, static_cast<off_t>(first + used));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) fail(got < 0 ? "cannot read: " + std::string(std::strerror(errno)) : "the file became shorter");
      used += static_cast<std::size_t>(got);
    }
    return text;
  }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(message, {path_}, Fault::data); }

 private:
  const std::string path_;
  int descriptor_;
  std::size_t size_ = 0;
};

class CsvRows : public RowSource {
 public:
  CsvRows(const std::string& path, const ReadOptions& options, const Progress& progress)
      : file_(path),
        parser_(path, options,
                "; mend it, or delete the line and use lunid.read, whose resample = true interpolates missing rows") {
    Layout& layout = layout_;
    layout.name = path;
    CsvParser all = look_through(path, options, progress, layout);
    all.judge(layout.warnings);
    for (const ColumnPlan& plan : all.table().plans) {
      if (plan.channel == "t" || plan.channel.empty()) continue;
      const auto& columns = parser_.table().plans;
      const auto same = [&](const ColumnPlan& other) { return other.header.text == plan.header.text; };
      columns_.push_back(
          static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), same) - columns.begin()));
      layout.channels.push_back(channel_of(plan));
    }
    if (columns_.empty())
      throw InputError("expected a column of numbers beside the time", {path, all.table().header_line}, Fault::data);
  }

  std::vector<VectorXd> read(Index first, Index count) const override {
    const auto after = [](Index row, const Piece& piece) { return row < piece.row; };
    const auto from = std::upper_bound(pieces_.begin(), pieces_.end(), first, after) - 1;
    const auto to = std::upper_bound(from, pieces_.end(), first + count - 1, after);
    const std::size_t end = to == pieces_.end() ? file_.size() : to->offset;
    CsvParser parser = parser_;
    parser.restart(from->line);
    parser.rows(file_.read(from->offset, end - from->offset));
    const CsvTable& table = parser.table();
    const Index skip = first - from->row;
    if (static_cast<Index>(table.lines.size()) < skip + count) file_.fail("the file changed while it was read");
    std::vector<VectorXd> out;
    for (const std::size_t i : columns_) {
      out.push_back(Eigen::Map<const VectorXd>(table.columns[i].data() + skip, count));
      if (table.plans[i].factor != 1) out.back() *= table.plans[i].factor;
    }
    return out;
  }

 private:
  /// Whole lines from `offset` on, of which the first row is number `row`; `line` stands before them.
  struct Piece {
    std::size_t offset;
    int line;
    Index row;
  };

  /// Reads the whole file once: where its rows are, their time, and what is no number.
  CsvParser look_through(const std::string& path, const ReadOptions& options, const Progress& progress,
                         Layout& layout) {
    std::string text = file_.read(0, piece_bytes);
    check_text(path, text);
    std::size_t offset = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
    const std::string_view rest = parser_.header(std::string_view(text).substr(offset), layout.warnings);
    offset = text.size() - rest.size();
    CsvParser all = parser_;
    Stamps stamps;
    while (offset < file_.size()) {
      text = file_.read(offset, piece_bytes);
      while (offset + text.size() < file_.size() && text.find(all.ending()) == text.npos)
        text += file_.read(offset + text.size(), piece_bytes);
      if (offset + text.size() < file_.size()) text.resize(text.rfind(all.ending()) + 1);
      all.restart(all.line());
      const int line = all.line();
      all.rows(text);
      all.refuse_bad_cells();
      if (!all.table().lines.empty()) pieces_.push_back({offset, line, layout.rows});
      layout.rows += static_cast<Index>(all.table().lines.size());
      if (options.interval == 0) add_stamps(stamps, all);
      offset += text.size();
      if (progress) progress(static_cast<double>(offset) / static_cast<double>(file_.size()));
    }
    parser_.agree_with(all);
    check_rows(layout.rows, path);
    layout.dt = options.interval;
    if (options.interval == 0) {
      const TimeBase base = stamps.fit(path, layout.warnings);
      layout.t0 = base.t0;
      layout.dt = base.dt;
    }
    return all;
  }

  static void add_stamps(Stamps& stamps, const CsvParser& parser) {
    const CsvTable& table = parser.table();
    const double factor = table.plans[parser.time()].factor;
    std::vector<double> t = table.columns[parser.time()], resolution(t.size());
    for (std::size_t i = 0; i < t.size(); ++i) {
      resolution[i] = factor * table.time_digits.resolution(t[i]);
      t[i] *= factor;
    }
    stamps.add(t, resolution, table.lines);
  }

  File file_;
  CsvParser parser_;  // after the header
  std::vector<Piece> pieces_;
  std::vector<std::size_t> columns_;  // of the file, that are channels
};

}  // namespace

std::unique_ptr<RowSource> open_csv_rows(const std::string& path, const ReadOptions& options,
                                         const Progress& progress) {
  return std::make_unique<CsvRows>(path, options, progress);
}

}  // namespace lunid
