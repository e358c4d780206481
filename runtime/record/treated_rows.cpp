#include "record/treated_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "record/extension.hpp"
#include "record/method_parts.hpp"
#include "record/motion.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Columns = std::vector<VectorXd>;

std::span<const double> span_of(const VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

class TreatedRows : public RowSource {
 public:
  explicit TreatedRows(Rows below) : below_(std::move(below)) { layout_ = below_->layout(); }
  void count_read(Index rows) const override { below_->count_read(rows); }

 protected:
  /// The rows below from `low` on, as far as there are any.
  struct Piece {
    Index low = 0;
    Columns columns;
  };
  Piece around(Index from, Index to) const {
    const Index low = std::max<Index>(from, 0);
    return {low, below_->read(low, std::min(to, below_->layout().rows) - low)};
  }

  const Rows below_;
};

class PartOfRows : public TreatedRows {
 public:
  PartOfRows(const Rows& below, Index first, Index count) : TreatedRows(below), first_(first) {
    layout_.t0 += layout_.dt * static_cast<double>(first);
    layout_.rows = count;
  }
  Columns read(Index first, Index count) const override { return below_->read(first_ + first, count); }

 private:
  Index first_;
};

/// The continuations of some channels: one pass for their lines, and a look at both ends.
std::vector<Ends> ends_of_rows(const RowSource& rows, const Places& places, Index reach) {
  const Index all = rows.layout().rows, near = ends_rows(all);
  std::vector<PolynomialSum> sums(places.size(), PolynomialSum(all, 1));
  for_each_piece(rows, [&](Index, const Columns& columns) {
    for (std::size_t i = 0; i < places.size(); ++i) sums[i].add(span_of(columns[places[i]]));
  });
  const Columns head = rows.read(0, near), tail = rows.read(all - near, near);
  std::vector<Ends> ends;
  for (std::size_t i = 0; i < places.size(); ++i)
    ends.push_back(ends_of(head[places[i]], tail[places[i]], sums[i], all, reach));
  return ends;
}

class FilteredRows : public TreatedRows {
 public:
  FilteredRows(const Rows& below, const Places& places, const FilterOptions& options)
      : TreatedRows(below),
        places_(places),
        sections_(butterworth(options.band, options.order, layout_.dt)),
        line_(passes_line(options.band)),
        reach_(filter_reach(sections_, furthest_reach)) {
    if (reach_ > furthest_reach)
      refuse("filter", "its response lasts over " + std::to_string(furthest_reach) +
                           " rows, the most of a stream: decimate it first, or read the record by lunid.read");
    ends_ = ends_of_rows(*below_, places_, filter_extension(sections_, layout_.rows));
    const double passed = noise_passed(sections_, layout_.dt);
    std::vector<std::string> names;
    for (const std::size_t place : places_) {
      layout_.channels[place].noise *= passed;
      names.push_back(layout_.channels[place].name);
    }
    layout_.history.push_back(filter_note(names, options));
  }

  Columns read(Index first, Index count) const override {
    const Index beyond = ends_.empty() ? 0 : ends_[0].reach();
    const Index low = std::max(first - reach_, -beyond), high = std::min(first + count + reach_, layout_.rows + beyond);
    Piece piece = around(low, high);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      VectorXd& column = piece.columns[places_[i]];
      VectorXd x = ends_[i].around(low, high - low, column);
      run_zero_phase(sections_, x);
      column = x.segment(piece.low - low, column.size());
      if (!line_) continue;
      for (Index k = 0; k < column.size(); ++k) column[k] += ends_[i].line(static_cast<double>(piece.low + k));
    }
    for (VectorXd& column : piece.columns) column = column.segment(first - piece.low, count).eval();
    return std::move(piece.columns);
  }

 private:
  const Places places_;
  const std::vector<Section> sections_;
  const bool line_;
  const Index reach_;
  std::vector<Ends> ends_;
};

class DetrendedRows : public TreatedRows {
 public:
  DetrendedRows(const Rows& below, const Places& places, int degree)
      : TreatedRows(below), places_(places), sums_(places.size(), PolynomialSum(layout_.rows, degree)) {
    for_each_piece(*below_, [&](Index, const Columns& columns) {
      for (std::size_t i = 0; i < places_.size(); ++i) sums_[i].add(span_of(columns[places_[i]]));
    });
    std::vector<std::string> names;
    for (const std::size_t place : places_) names.push_back(layout_.channels[place].name);
    layout_.history.push_back(detrend_note(names, degree));
  }

  Columns read(Index first, Index count) const override {
    Columns columns = below_->read(first, count);
    for (std::size_t i = 0; i < places_.size(); ++i) columns[places_[i]] -= sums_[i].values(first, count);
    return columns;
  }

 private:
  const Places places_;
  std::vector<PolynomialSum> sums_;
};

class RatedRows : public TreatedRows {
 public:
  RatedRows(const Rows& below, const NewRate& rate) : TreatedRows(below), rate_(rate), between_(rate.step) {
    Places all(layout_.channels.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    ends_ = ends_of_rows(*below_, all, between_.margin());
    layout_.dt = rate.dt;
    layout_.rows = rate.rows;
    for (Channel& channel : layout_.channels) channel.noise *= between_.noise_passed();
    layout_.history.push_back(rate.note);
  }

  Columns read(Index first, Index count) const override {
    const auto at = [&](Index row) { return rate_.step * static_cast<double>(row); };
    const Index margin = between_.margin();
    const auto low = std::max(static_cast<Index>(at(first)) - margin, -margin);
    const auto high = std::min(static_cast<Index>(at(first + count - 1)) + margin + 1, ends_[0].rows + margin);
    Columns columns = around(low, high).columns;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const VectorXd x = ends_[i].around(low, high - low, columns[i]);
      columns[i] = VectorXd::NullaryExpr(count, [&](Index k) {
        const double row = at(first + k);
        return between_(x, low, row) + ends_[i].line(row);
      });
    }
    return columns;
  }

  void count_read(Index rows) const override { TreatedRows::count_read(static_cast<Index>(rate_.step * rows)); }

 private:
  const NewRate rate_;
  const BandLimited between_;
  std::vector<Ends> ends_;
};

class IntegratedRows : public TreatedRows {
 public:
  IntegratedRows(const Rows& below, std::size_t place) : TreatedRows(below), place_(place) {
    layout_.channels.push_back({});
    double low = std::numeric_limits<double>::infinity(), high = -low;
    marks_.push_back(0);
    for (Index at = 0; at < layout_.rows; at += stream_rows) {
      const Index count = std::min(stream_rows, layout_.rows - at);
      const Piece piece = around(at - 1, at + count + 2);
      const VectorXd& x = piece.columns[place_];
      low = std::min(low, x.minCoeff());
      high = std::max(high, x.maxCoeff());
      const Index more = std::min(count + 1, layout_.rows - at);  // as far as the first row of the next piece
      marks_.push_back(continued_integral(marks_.back(), x, piece.low, at, more, layout_.rows, layout_.dt)[more - 1]);
      count_read(count);
    }
    if (low == high)
      refuse("integrate", "channel '" + layout_.channels[place].name + "' is constant, " + short_number(low) +
                              ": there is no motion in it");
  }

  Columns read(Index first, Index count) const override {
    const Index mark = first / stream_rows, from = mark * stream_rows;
    Piece piece = around(from - 1, first + count + 2);
    const VectorXd whole = continued_integral(marks_[static_cast<std::size_t>(mark)], piece.columns[place_], piece.low,
                                              from, first + count - from, layout_.rows, layout_.dt);
    for (VectorXd& column : piece.columns) column = column.segment(first - piece.low, count).eval();
    piece.columns.push_back(whole.tail(count));
    return std::move(piece.columns);
  }

 private:
  const std::size_t place_;
  std::vector<double> marks_;  // the integral at every stream_rows-th row
};

class ArrangedRows : public TreatedRows {
 public:
  ArrangedRows(const Rows& below, const Places& places, std::vector<Channel> channels, std::vector<std::string> history)
      : TreatedRows(below), places_(places) {
    layout_.channels = std::move(channels);
    layout_.history = std::move(history);
  }

  Columns read(Index first, Index count) const override {
    const Columns all = below_->read(first, count);
    Columns columns;
    for (const std::size_t place : places_) columns.push_back(all[place]);
    return columns;
  }

 private:
  const Places places_;
};

}  // namespace

Rows part_of(const Rows& rows, Index first, Index count) { return std::make_shared<PartOfRows>(rows, first, count); }

Rows filtered_rows(const Rows& rows, const Places& places, const FilterOptions& options) {
  return std::make_shared<FilteredRows>(rows, places, options);
}

Rows detrended_rows(const Rows& rows, const Places& places, int degree) {
  return std::make_shared<DetrendedRows>(rows, places, degree);
}

Rows rated_rows(const Rows& rows, const NewRate& rate) { return std::make_shared<RatedRows>(rows, rate); }

Rows integrated_rows(const Rows& rows, std::size_t place) { return std::make_shared<IntegratedRows>(rows, place); }

Rows arranged_rows(const Rows& rows, const Places& places, std::vector<Channel> channels,
                   std::vector<std::string> history) {
  return std::make_shared<ArrangedRows>(rows, places, std::move(channels), std::move(history));
}

}  // namespace lunid
