#include "discover/naming.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "discover/grow.hpp"
#include "discover/judge.hpp"
#include "discover/linearised.hpp"
#include "discover/ties.hpp"
#include "discover/verdict.hpp"
#include "record/random.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double ridge = 1e-9;  ///< on columns of length one
constexpr Eigen::Index fewest_blocks = 20, most_blocks = 1000;

/// Sums over each block of a finalist's linearised problem.
struct Finalist {
  const Candidate* candidate = nullptr;
  std::vector<double> squares;
  std::vector<VectorXd> right;
  std::vector<MatrixXd> gram;
};

/// A finalist on one resample.
struct Drawn {
  double cost = 0;
  VectorXd log_likelihood;  ///< of each drawn block
};

class Resampler {
 public:
  Resampler(const Study& study, const SearchResult& found)
      : study_(study), tried_(found.grown.tried), chosen_(found.chosen) {
    can_be_told_ = add(found.baseline, found.whitening);
    if (!found.chosen.choices.empty()) can_be_told_ = add(found.chosen, found.whitening) && can_be_told_;
    // What likelihood alone prefers was refused by runs over left-out blocks, what the test took back by that record,
    // and what another channel denies by that: a resample makes none again.
    const auto denied = [&](const Choices& set) {
      return std::ranges::any_of(found.denied, [&](const Choices& part) { return within(part, set); });
    };
    const auto refused = [&](const Beaten& rival) {
      return !found.chosen.choices.empty() && (rival.by == Beaten::By::test || denied(rival.model.choices) ||
                                               !not_rejected(study, found.chosen, rival.model, tried_));
    };
    for (const Beaten& rival : found.rivals)
      if (const Candidate& c = rival.model; c.ran() && c.innovations.size() > 0 && !refused(rival))
        add(c, found.whitening);
  }

  bool possible() const { return can_be_told_ && finalists_.size() > 1 && blocks_.size() >= 10; }

  /// The name that a resample gives.
  std::string name(std::uint64_t draw) const {
    Philox random(study_.options->seed, stream_of("naming") + draw);
    std::vector<std::size_t> drawn;
    double rows = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      drawn.push_back(random.below(blocks_.size()));
      rows += static_cast<double>(blocks_[drawn.back()]);
    }
    std::vector<Drawn> all;
    for (const Finalist& f : finalists_) all.push_back(refit(f, drawn, rows));
    const Candidate& chosen = *finalists_[choose(all, rows)].candidate;
    if (chosen.choices.empty()) return "nothing";
    return same_in_other_words(chosen, chosen_) ? chosen_.name() : chosen.name();
  }

 private:
  /// False where its run cannot be had to first order.
  bool add(const Candidate& candidate, const Whitening& whitening) {
    Linearised linear;
    if (!candidate.ran() ||
        !linearise(study_, *candidate.system, candidate.whitened.theta, candidate.whitened, whitening, linear))
      return false;
    project_first_states(linear);
    hold_and_scale(candidate.system->model(), candidate.whitened, linear.columns);
    Finalist out;
    out.candidate = &candidate;
    const auto whole = static_cast<Index>(linear.residual.size());
    const Index length = std::clamp<Index>(bootstrap_block(study_) / whitening.average, 1 + whole / most_blocks,
                                           std::max<Index>(1 + whole / most_blocks, whole / fewest_blocks));
    std::vector<Index> sizes;
    for (std::size_t r = 0; r + 1 < linear.row_of_record.size(); ++r)
      for (Index first = linear.row_of_record[r]; first + length <= linear.row_of_record[r + 1]; first += length) {
        const auto j = linear.columns.middleRows(first, length);
        const auto e = linear.residual.segment(first, length);
        out.squares.push_back(e.squaredNorm());
        out.right.push_back(j.transpose() * e);
        out.gram.push_back(j.transpose() * j);
        sizes.push_back(length);
      }
    blocks_ = std::move(sizes);
    finalists_.push_back(std::move(out));
    return true;
  }

  Drawn refit(const Finalist& f, const std::vector<std::size_t>& drawn, double rows) const {
    const Index p = f.right.front().size();
    MatrixXd gram = MatrixXd::Zero(p, p);
    VectorXd right = VectorXd::Zero(p);
    double squares = 0;
    for (const std::size_t b : drawn) {
      gram += f.gram[b];
      right += f.right[b];
      squares += f.squares[b];
    }
    gram.diagonal().array() += ridge;
    const VectorXd step = gram.ldlt().solve(right);
    Drawn out;
    out.cost = squares - right.dot(step);
    const double variance = out.cost / rows;
    out.log_likelihood.resize(static_cast<Index>(drawn.size()));
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const std::size_t b = drawn[i];
      const double own = f.squares[b] - 2 * f.right[b].dot(step) + step.dot(f.gram[b] * step);
      out.log_likelihood[static_cast<Index>(i)] =
          -0.5 * (static_cast<double>(blocks_[b]) * std::log(variance) + own / variance);
    }
    return out;
  }

  double price(std::size_t i, double rows) const { return price_of_unknowns(*finalists_[i].candidate, rows); }

  const Choices& choices(std::size_t i) const { return finalists_[i].candidate->choices; }

  /// Corrected p-value of the larger of two nested sets.
  double p_value(const std::vector<Drawn>& all, std::size_t small, std::size_t large, double rows) const {
    const double p = improvement_p_value(*finalists_[small].candidate, *finalists_[large].candidate, all[small].cost,
                                         all[large].cost, rows);
    return corrected(p, tried_);
  }

  double vuong(const std::vector<Drawn>& all, std::size_t a, std::size_t b, double rows) const {
    const VectorXd difference = all[a].log_likelihood - all[b].log_likelihood;
    const double mean = difference.mean();
    const double variance = (difference.array() - mean).square().sum();
    const double correction = price(a, rows) - price(b, rows);
    return variance > 0 ? (difference.sum() - correction) / std::sqrt(variance) : 0;
  }

  bool fits_worse(const std::vector<Drawn>& all, std::size_t i, std::size_t best, double rows) const {
    return vuong(all, best, i, rows) >= vuong_level ||
           stays_above_noise(study_, all[i].cost, all[best].cost, rows, rms_error(finalists_[best].candidate->fit));
  }

  std::size_t choose(const std::vector<Drawn>& all, double rows) const {
    std::size_t best = 1;
    const auto cost = [&](std::size_t i) { return price(i, rows) - all[i].log_likelihood.sum(); };
    for (std::size_t i = 1; i < all.size(); ++i)
      if (cost(i) < cost(best)) best = i;
    std::size_t pick = best;
    const double alpha = study_.options->alpha;
    for (std::size_t i = 1; i < all.size(); ++i) {
      const bool stays =
          within(choices(i), choices(best)) ? p_value(all, i, best, rows) > alpha : !fits_worse(all, i, best, rows);
      if (stays && simplicity(*finalists_[i].candidate) < simplicity(*finalists_[pick].candidate)) pick = i;
    }
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < all.size() && !again; ++i)
        if (choices(i).size() < choices(pick).size() && within(choices(i), choices(pick)) && !gains(all, i, pick)) {
          pick = i;
          again = true;
        }
    }
    return p_value(all, 0, pick, rows) > alpha ? 0 : pick;
  }

  /// The least gain that is asked of a larger set. The gain that counted for the chosen one was that of runs over
  /// left-out blocks: where its whitened error has less, half of what that has on all rows.
  bool gains(const std::vector<Drawn>& all, std::size_t small, std::size_t large) const {
    const auto whole = [&](std::size_t i) { return finalists_[i].candidate->whitened.cost; };
    double least = required_gain(study_, rms_error(finalists_[large].candidate->fit) / study_.measured_std());
    if (finalists_[large].candidate == &chosen_)
      least = std::min(least, 0.5 * (1 - std::sqrt(whole(large) / whole(small))));
    return std::sqrt(all[large].cost) < (1 - least) * std::sqrt(all[small].cost);
  }

  const Study& study_;
  int tried_;
  const Candidate& chosen_;
  bool can_be_told_ = false;         ///< the baseline and the chosen set are finalists
  std::vector<Finalist> finalists_;  ///< the baseline first
  std::vector<Index> blocks_;        ///< rows of each
};

}  // namespace

int Naming::of(const std::string& name) const {
  for (const auto& [set, count] : counts)
    if (set == name) return count;
  return 0;
}

Naming bootstrap_naming(const Study& study, const SearchResult& found, int resamples) {
  Naming out;
  if (!found.baseline.ran()) return out;
  const Resampler resampler(study, found);
  if (!resampler.possible()) return out;
  out.resamples = resamples;
  for (int draw = 0; draw < resamples; ++draw) {
    const std::string name = resampler.name(static_cast<std::uint64_t>(draw));
    const auto at = std::find_if(out.counts.begin(), out.counts.end(), [&](const auto& c) { return c.first == name; });
    if (at == out.counts.end())
      out.counts.push_back({name, 1});
    else
      ++at->second;
  }
  std::stable_sort(out.counts.begin(), out.counts.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

}  // namespace lunid
