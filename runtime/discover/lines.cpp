#include "discover/lines.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "discover/receptance.hpp"
#include "record/median.hpp"
#include "record/spectrum.hpp"

namespace lunid {

namespace {

/// The power of x under a Hann window, in the bins of a spectrum that is padded to four bins per line of the window.
Eigen::VectorXd padded_power(Eigen::VectorXd x) {
  constexpr Eigen::Index padding = 4;
  x.array() -= x.mean();
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] *= 1 - std::cos(2 * M_PI * (static_cast<double>(i) + 0.5) / static_cast<double>(x.size()));
  return half_spectrum(view(x), padding * power_of_two_above(x.size())).cwiseAbs2().cwiseMax(1e-300);
}

/// The angular frequencies of the highest peaks of a padded power of so many rows, at most eight.
std::vector<double> strongest_lines(const Eigen::VectorXd& power, Eigen::Index rows, double dt) {
  constexpr std::size_t most = 8;
  const double step = M_PI / (static_cast<double>(power.size() - 1) * dt);
  const double apart = 4 * M_PI / (static_cast<double>(rows) * dt);  // half of the window's main lobe
  std::vector<std::pair<double, double>> peaks;
  for (Eigen::Index k = 1; k + 1 < power.size(); ++k) {
    if (!(power[k] > power[k - 1] && power[k] >= power[k + 1])) continue;
    const double a = std::log(power[k - 1]), b = std::log(power[k]), c = std::log(power[k + 1]);
    const double bend = a - 2 * b + c;
    peaks.emplace_back(power[k], (static_cast<double>(k) + (bend < 0 ? 0.5 * (a - c) / bend : 0)) * step);
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<double> lines;
  for (const auto& [height, omega] : peaks) {
    if (lines.size() == most) break;
    if (std::all_of(lines.begin(), lines.end(), [&](double other) { return std::abs(other - omega) > apart; }))
      lines.push_back(omega);
  }
  return lines;
}

}  // namespace

std::vector<double> residual_lines(const Study& study, const Candidate& candidate) {
  if (!candidate.ran()) return {};
  const auto& all = candidate.fit.residual;
  const auto longest =
      std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return strongest_lines(padded_power(*longest), longest->size(),
                         study.train[static_cast<std::size_t>(longest - all.begin()) % study.train.size()].record.dt());
}

namespace {

/// Columns of coordinates, one after another, each from its end.
Eigen::VectorXd reversed(const Eigen::VectorXd& columns, Eigen::Index rows) {
  Eigen::VectorXd out(columns.size());
  for (Eigen::Index first = 0; first < columns.size(); first += rows)
    out.segment(first, rows) = columns.segment(first, rows).reverse();
  return out;
}

/// The mean of a power over each of so many bands of the same width.
Eigen::VectorXd over_bands(const Eigen::VectorXd& power, Eigen::Index bands) {
  Eigen::VectorXd out(bands);
  for (Eigen::Index b = 0; b < bands; ++b) {
    const Eigen::Index first = b * power.size() / bands, end = std::max(first + 1, (b + 1) * power.size() / bands);
    out[b] = power.segment(first, end - first).mean();
  }
  return out;
}

/// The power of y*cos(w*t) behind a filter, in the bins of a padded power, for w in each of these.
Eigen::VectorXd power_behind(const Eigen::VectorXd& filter, const Eigen::VectorXd& y) {
  constexpr Eigen::Index bands = 256;
  const Eigen::VectorXd passes = over_bands(filter, bands), holds = over_bands(y, bands);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(bands);
  for (Eigen::Index w = 0; w < bands; ++w)
    for (Eigen::Index k = 0; k < bands; ++k)
      out[w] += passes[k] * (holds[std::abs(k - w)] + (k + w < bands ? holds[k + w] : 0));
  Eigen::VectorXd fine(y.size());
  for (Eigen::Index i = 0; i < fine.size(); ++i) {
    const double at =
        std::clamp((static_cast<double>(i) + 0.5) * bands / static_cast<double>(y.size()) - 0.5, 0.0, bands - 1.0);
    const Eigen::Index low = std::min<Eigen::Index>(static_cast<Eigen::Index>(at), bands - 2);
    fine[i] = out[low] + (at - static_cast<double>(low)) * (out[low + 1] - out[low]);
  }
  return fine;
}

/// A stiffness that goes up and down, beside a model over the longest training record: f = a*cos(w*t)*y.
class Modulation {
 public:
  Modulation(const Study& study, const Candidate& candidate, const std::optional<Place>& place)
      : place_(place), degrees_(study.degrees()), alpha_(study.options->alpha) {
    const auto longest =
        std::ranges::max_element(study.force, {}, [](const FitData& data) { return data.record.rows(); });
    data_ = {*longest};
    if (std::ranges::find(longest->use, 1) == longest->use.end()) return;
    if (!study.imposed) receptance_ = Receptance(study, candidate, data_);
    const auto& residual = candidate.fit.residual;
    const auto which = static_cast<std::size_t>(longest - study.force.begin());
    if (!study.imposed && candidate.ran() && residual.size() == study.force.size() &&
        residual[which].size() == degrees_ * rows()) {
      left_ = residual[which];
    } else {
      const Eigen::VectorXd open = open_force(candidate, candidate.best_theta(), longest->record);
      if (!open.allFinite()) return;
      left_ = moved(open);
    }
    y_ = motion_at(longest->record, place, 'y');
    find_power();
  }

  /// The frequencies that stand out, of those at which it would take most of what is left. What goes round less than
  /// twice changes slowly.
  std::vector<double> lines() const {
    if (left_.size() == 0) return {};
    std::vector<double> out = strongest_lines(power_, rows(), dt());
    const double slowest = 4 * M_PI / data_.front().record.duration();
    std::erase_if(out, [&](double omega) { return !(omega > slowest) || !stands_out(omega); });
    return out;
  }

 private:
  Eigen::Index rows() const { return data_.front().record.rows(); }
  double dt() const { return data_.front().record.dt(); }
  Eigen::VectorXd moved(const Eigen::VectorXd& force) const { return receptance_.motion_of(force, data_, degrees_); }

  /// On all coordinates, of a force at the place.
  Eigen::VectorXd spread(const Eigen::VectorXd& force) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(degrees_ * rows());
    out.segment((place_ ? place_->of : 0) * rows(), rows()) = force;
    if (place_ && place_->joint()) out.segment(place_->from * rows(), rows()) = -force;
    return out;
  }

  /// What the motion that is left has in common with the motion that a force f makes, f has in common with the former
  /// put back through the receptance from its end: of all frequencies at once the Fourier transform of that times y,
  /// over the size of the motion that each makes, which is what noise would have in common with it.
  void find_power() {
    const std::vector<std::uint8_t>& use = data_.front().use;
    const Eigen::VectorXd back = reversed(moved(reversed(left_, rows())), rows());
    Eigen::VectorXd shared = force_at(back, rows(), place_);
    for (Eigen::Index i = 0; i < rows(); ++i) shared[i] *= use[static_cast<std::size_t>(i)] ? y_[i] : 0;
    power_ = padded_power(std::move(shared));
    Eigen::VectorXd blow = Eigen::VectorXd::Zero(rows());
    blow[std::ranges::find(use, 1) - use.begin()] = 1;
    const Eigen::VectorXd answer = moved(spread(blow));
    Eigen::VectorXd passes = Eigen::VectorXd::Zero(power_.size());
    for (Eigen::Index i = 0; i < degrees_; ++i) {
      const Eigen::VectorXd of_one = answer.segment(i * rows(), rows());
      passes += half_spectrum(view(of_one), 2 * (power_.size() - 1)).cwiseAbs2();
    }
    const Eigen::VectorXd size = power_behind(passes, padded_power(y_));
    power_ = power_.cwiseQuotient(size.cwiseMax(1e-6 * size.maxCoeff()));
  }

  /// Of all frequencies this one by no chance, or it takes most of what is left.
  bool stands_out(double omega) const { return is_beyond_chance(omega) || share(omega) > 0.5; }

  /// Of noise the bins are exponential, their median ln 2 of their mean.
  bool is_beyond_chance(double omega) const {
    const Eigen::Index last = power_.size() - 1, about = last / 32;
    const auto at =
        std::min(last, static_cast<Eigen::Index>(std::lround(omega * dt() / M_PI * static_cast<double>(last))));
    const Eigen::Index first = std::max<Eigen::Index>(0, at - about), end = std::min(last, at + about) + 1;
    const double mean = middle_value({power_.data() + first, power_.data() + end}) / M_LN2,
                 tried = 0.5 * static_cast<double>(rows());
    return power_[at] > mean * std::log(tried / (0.1 * alpha_));
  }

  /// Of the squares of what is left.
  double share(double omega) const {
    Eigen::MatrixXd columns(left_.size(), 2);
    const auto phase = Eigen::ArrayXd::LinSpaced(rows(), 0, omega * dt() * static_cast<double>(rows() - 1));
    columns.col(0) = moved(spread(y_.array() * phase.cos()));
    columns.col(1) = moved(spread(y_.array() * phase.sin()));
    const Eigen::VectorXd taken = columns * columns.colPivHouseholderQr().solve(left_);
    return 1 - (left_ - taken).squaredNorm() / left_.squaredNorm();
  }

  std::vector<FitData> data_;  ///< the longest
  std::optional<Place> place_;
  Eigen::Index degrees_;
  double alpha_;
  Receptance receptance_;             ///< with imposed motion forces stay as they are
  Eigen::VectorXd left_, y_, power_;  ///< power_: over w, padded
};

}  // namespace

std::vector<double> modulation_lines(const Study& study, const Candidate& candidate,
                                     const std::optional<Place>& place) {
  return Modulation(study, candidate, place).lines();
}

}  // namespace lunid
