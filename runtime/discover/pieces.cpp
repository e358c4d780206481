// Pieces of long records: enough to find a name by, when all rows would take minutes to each candidate. And short runs,
// of records over which no run holds.
#include <algorithm>
#include <cmath>

#include "discover/study.hpp"

namespace lunid {

namespace {

using Eigen::Index;

constexpr Index searched_rows = 6000;   // of all training records together
constexpr Index searched_first = 3000;  // the same, and a quarter of the rows of longer records
constexpr Index fewest_rows = 1500;     // of a piece
constexpr double fewest_periods = 20;   // of the motion in a piece
constexpr Index run_rows = 12000;       // of all parts of the records together, where those are cut into short runs
constexpr Index fewest_rows_of_run = 40;

struct Piece {
  std::size_t record;
  Index first, count;
};

/// The row of [from, to) that is farthest from their mean.
Index farthest(const Eigen::VectorXd& motion, Index from, Index to) {
  Index row = 0;
  const auto part = motion.segment(from, to - from).array();
  (part - part.mean()).abs().maxCoeff(&row);
  return from + row;
}

/// A record's share of the rows, spread evenly over it, so that what changes slowly stays in sight. Every second piece
/// lies where its part of the record moves most, and one where the whole record does: a resonance that is swept
/// through, a stop that is seldom reached.
void cut(const Record& record, std::size_t index, const std::string& channel, Index length, Index count,
         std::vector<Piece>& out) {
  const Index rows = record.rows();
  const Eigen::VectorXd motion = Eigen::Map<const Eigen::VectorXd>(record[channel].data(), rows);
  const Index largest = farthest(motion, 0, rows);
  for (Index k = 0; k < count; ++k) {
    const Index from = rows * k / count, to = rows * (k + 1) / count;
    const bool holds_it = from <= largest && largest < to;
    const Index middle = holds_it ? largest : k % 2 == 1 ? farthest(motion, from, to) : from;
    out.push_back({index, std::clamp(middle - length / 2, from, to - length), length});
  }
}

std::vector<Piece> pieces_of(const Study& study, Searched searched) {
  const Index all = study.rows();
  const Index wanted = searched == Searched::first ? std::clamp(all / 4, searched_first, searched_rows) : searched_rows;
  if (study.imposed || study.run_length > 0 || all <= wanted * 5 / 4) return {};
  std::vector<Piece> out;
  for (std::size_t r = 0; r < study.train.size(); ++r) {
    const Record& record = study.train[r].record;
    const double period = study.omega > 0 ? 2 * M_PI / study.omega / record.dt() : 0;
    const Index length = std::max(fewest_rows, static_cast<Index>(std::ceil(fewest_periods * period)));
    const auto share = static_cast<double>(record.rows()) / static_cast<double>(all);
    const auto count =
        std::max<Index>(1, std::lround(share * static_cast<double>(wanted) / static_cast<double>(length)));
    if (count * length < record.rows())
      cut(record, r, study.output(), length, count, out);
    else
      out.push_back({r, 0, record.rows()});
  }
  return out;
}

/// Consecutive parts of a record, evenly spread where they would be more than `most` rows together.
std::vector<Piece> parts_of(const Record& record, std::size_t index, double length, Index most) {
  const Index rows = record.rows();
  const Index own = std::clamp<Index>(static_cast<Index>(std::lround(length / record.dt())), fewest_rows_of_run, rows);
  const Index all = rows / own, count = std::clamp<Index>(most / own, 1, all);
  std::vector<Piece> out;
  for (Index k = 0; k < count; ++k) out.push_back({index, k * all / count * own, own});
  return out;
}

/// What is searched, of these pieces.
Study of_pieces(const Study& whole, const std::vector<Piece>& pieces) {
  Study out = whole;
  out.train.clear();
  out.smooth.clear();
  out.force.clear();
  out.guesses.clear();
  out.recorded.clear();
  for (const Piece& piece : pieces) {
    out.train.push_back(whole.train[piece.record].part(piece.first, piece.count));
    out.smooth.push_back(whole.smooth[piece.record].slice(piece.first, piece.count));
    out.force.push_back(whole.force[piece.record].part(piece.first, piece.count));
    out.guesses.push_back(whole.guesses[piece.record]);
    out.recorded.push_back(whole.recorded[piece.record]);
  }
  return out;
}

std::vector<Piece> short_parts(const std::vector<Record>& records, double length) {
  std::vector<Piece> out;
  for (std::size_t r = 0; r < records.size(); ++r)
    for (const Piece& p : parts_of(records[r], r, length, run_rows / std::ssize(records))) out.push_back(p);
  return out;
}

std::vector<Record> short_runs(const std::vector<Record>& records, double length) {
  std::vector<Record> out;
  for (const Piece& p : short_parts(records, length)) out.push_back(records[p.record].slice(p.first, p.count));
  return out;
}

}  // namespace

Study in_short_runs(const Study& whole, double periods) {
  const double length = periods * 2 * M_PI / upper_frequency(whole);
  std::vector<Record> trained;
  for (const FitData& data : whole.train) trained.push_back(data.record);
  Study out = of_pieces(whole, short_parts(trained, length));
  out.run_length = length;
  out.full = short_runs(whole.full, length);
  out.test = short_runs(whole.test, length);
  return out;
}

Study shortened(const Study& whole, Searched searched) {
  const std::vector<Piece> pieces = pieces_of(whole, searched);
  if (pieces.empty()) return whole;
  Study out = of_pieces(whole, pieces);
  out.in_pieces = true;
  return out;
}

}  // namespace lunid
