// Derived channels of a stream: what is made of what, with which parameters.
#include "record/blockwise.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "expr/joined.hpp"
#include "record/method_parts.hpp"
#include "record/motion.hpp"
#include "record/noise_sum.hpp"
#include "record/savitzky_golay.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* where = "stream";
/// A parameter that spectra do not give is chosen on so many parts of so many rows, or on a whole record that is no
/// longer.
constexpr Index parts_of_sample = 4, rows_of_part = 8192;

std::span<const double> span_of(const VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// What the look at a channel finds.
struct ChannelSums {
  explicit ChannelSums(Index rows, bool motion) : noise(rows) {
    if (motion) spectrum.emplace(rows, DerivativeError::segment_length(rows));
  }
  NoiseSum noise;
  std::optional<WelchSum> spectrum;
};

class Deriver {
 public:
  Deriver(const RowSource& source, RowSource::Layout& layout, const StreamOptions& options)
      : source_(source), layout_(layout), options_(options), measured_(layout.channels.size()) {
    if (options.smooth && std::holds_alternative<FiniteDifferences>(options.derivative))
      refuse(where, "smooth: expected a derivative that smooths, got finite_differences");
  }

  /// Finds the noise of each channel, and the spectra of the motion's.
  void look(const Progress& progress) {
    std::vector<ChannelSums> sums;
    for (const Channel& channel : layout_.channels)
      sums.emplace_back(layout_.rows, channel.name.find_first_of("yva") == 0);
    for (Index at = 0; at < layout_.rows; at += stream_rows) {
      const std::vector<VectorXd> columns = source_.read(at, std::min(stream_rows, layout_.rows - at));
      for (std::size_t i = 0; i < columns.size(); ++i) {
        sums[i].noise.add(span_of(columns[i]));
        if (sums[i].spectrum) sums[i].spectrum->add(span_of(columns[i]));
      }
      if (progress) progress(static_cast<double>(at) / static_cast<double>(layout_.rows));
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      layout_.channels[i].noise = sums[i].noise.level();
      still_.push_back(sums[i].noise.low() == sums[i].noise.high());
      spectra_.push_back(sums[i].spectrum ? std::optional(sums[i].spectrum->spectrum()) : std::nullopt);
    }
  }

  std::vector<BlockwiseChannels> run() {
    for (const std::string& suffix : suffixes()) {
      std::vector<std::size_t> channels;
      std::vector<int> ranks;
      for (int rank = 0; rank < 3; ++rank)
        if (const auto found = index(std::string(1, "yva"[rank]) + suffix)) {
          channels.push_back(*found);
          ranks.push_back(rank);
        }
      std::holds_alternative<KalmanSmoother>(options_.derivative) ? jointly(suffix, channels, ranks)
                                                                  : singly(suffix, channels, ranks);
    }
    return std::move(made_);
  }

 private:
  std::optional<std::size_t> index(const std::string& name) const {
    for (std::size_t i = 0; i < measured_; ++i)
      if (layout_.channels[i].name == name) return i;
    return std::nullopt;
  }

  std::vector<std::string> suffixes() const {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < measured_; ++i) {
      const std::string name = layout_.channels[i].name, suffix = name.substr(1);
      const bool own = suffix.find_first_not_of("0123456789") == std::string::npos || suffix == "b";
      if (name.find_first_of("yva") == 0 && own && std::find(all.begin(), all.end(), suffix) == all.end())
        all.push_back(suffix);
    }
    return all;
  }

  /// Rows of some channels on which a parameter is chosen, part after part.
  std::vector<std::vector<VectorXd>> sample(const std::vector<std::size_t>& channels) const {
    const bool whole = layout_.rows <= parts_of_sample * rows_of_part;
    const Index parts = whole ? 1 : parts_of_sample, count = whole ? layout_.rows : rows_of_part;
    std::vector<std::vector<VectorXd>> all;
    for (Index part = 0; part < parts; ++part) {
      const std::vector<VectorXd> columns =
          source_.read(whole ? 0 : part * (layout_.rows - count) / (parts - 1), count);
      all.emplace_back();
      for (const std::size_t channel : channels) all.back().push_back(columns[channel]);
    }
    return all;
  }

  std::string sample_words() const {
    if (layout_.rows <= parts_of_sample * rows_of_part) return "";
    return ", chosen on " + std::to_string(parts_of_sample) + " parts of " + std::to_string(rows_of_part) + " rows";
  }

  /// The method with nothing left to choose, and words on how that was done.
  std::pair<DerivativeMethod, std::string> chosen_for(std::size_t from, int derivative) {
    const double noise = layout_.channels[from].noise;
    const auto error = [&] { return DerivativeError(*spectra_[from], noise, derivative); };
    if (const auto* m = std::get_if<FiniteDifferences>(&options_.derivative))
      return {m->accuracy && m->step ? *m : chosen(*m, error(), noise, layout_.rows, derivative), ""};
    if (const auto* m = std::get_if<PolynomialWindow>(&options_.derivative))
      return {m->rows ? *m : chosen(*m, error(), layout_.rows, derivative), ""};
    if (const auto* m = std::get_if<SmoothedDifferences>(&options_.derivative))
      return {m->rows ? *m : chosen(*m, error(), layout_.rows, derivative), ""};
    const auto* spline = std::get_if<SmoothingSpline>(&options_.derivative);
    if (!spline || spline->weight > 0) return {options_.derivative, ""};
    const auto [fixed, fresh] = splines_.try_emplace(from, *spline);  // of all derivatives
    if (fresh) {
      const auto parts = sample({from});
      std::vector<std::span<const double>> spans;
      for (const auto& part : parts) spans.push_back(span_of(part[0]));
      fixed->second.weight = chosen_weight(*spline, spans, layout_.dt, noise);
    }
    return {fixed->second, choice_words(*spline) + sample_words()};
  }

  void singly(const std::string& suffix, const std::vector<std::size_t>& channels, const std::vector<int>& ranks) {
    const std::vector<Channel> given = layout_.channels;
    const auto add = [&](std::size_t from, int rank, int derivative, std::optional<std::size_t> in_place_of) {
      const Channel& source = given[from];
      if (still_[from]) {
        if (derivative == 0) return;
        made_.push_back({{from}, {}, {}, {derivative}, {layout_.channels.size()}, {}, 0, true});
        Channel channel;
        channel.name = std::string(1, "yva"[rank]) + suffix;
        channel.unit = motion_unit(source.unit, rank);
        layout_.channels.push_back(at_rest(channel, source.name, 0));
        return;
      }
      const auto [method, words] = chosen_for(from, derivative);
      const int own_rank = rank - derivative;
      const auto [settled, reach] = settled_reach(method, {&own_rank, 1}, {&source.noise, 1}, layout_.dt, derivative);
      // What it leaves of the noise, and its words: of any signal that is long enough.
      const VectorXd any = VectorXd::LinSpaced(std::max<Index>(2 * reach + 1, 8), 0, 1);
      const Derivative tried = differentiate(span_of(any), layout_.dt, source.noise, derivative, settled);
      made_.push_back({{from}, {own_rank}, {source.noise}, {derivative}, {}, settled, reach});
      place(std::string(1, "yva"[rank]) + suffix, rank, source, in_place_of, tried.noise,
            (in_place_of ? "smoothed by " : "of " + source.name + " by ") + tried.how + words);
    };
    for (int rank = 1; rank < 3; ++rank) {
      if (std::find(ranks.begin(), ranks.end(), rank) != ranks.end() || ranks.front() > rank) continue;
      const auto below = std::find_if(ranks.rbegin(), ranks.rend(), [&](int r) { return r < rank; });
      add(channels[static_cast<std::size_t>(ranks.rend() - below - 1)], rank, rank - *below, {});
    }
    if (!options_.smooth) return;
    for (std::size_t i = 0; i < channels.size(); ++i) add(channels[i], ranks[i], 0, channels[i]);
  }

  void jointly(const std::string& suffix, const std::vector<std::size_t>& channels, const std::vector<int>& ranks) {
    KalmanSmoother kalman = std::get<KalmanSmoother>(options_.derivative);
    const std::vector<Channel> given = layout_.channels;
    std::vector<int> wanted;
    for (int rank = ranks.front(); rank < 3; ++rank)
      if (options_.smooth || std::find(ranks.begin(), ranks.end(), rank) == ranks.end()) wanted.push_back(rank);
    if (wanted.empty()) return;
    for (const std::size_t channel : channels)
      if (still_[channel])
        refuse(where,
               "derivative: kalman: channel '" + given[channel].name + "' is constant: there is no motion in it");
    const auto parts = sample(channels);
    BlockwiseChannels made{channels, ranks, {}, {}, {}, {}, 0};
    std::vector<std::vector<Measurement>> measured(parts.size());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const auto& first = parts[0][i];
      // As kalman_smoother() has it, but the same for all blocks.
      const double least = 1e-7 * std::sqrt((first.array() - first.mean()).square().mean());
      made.noise.push_back(std::max(given[channels[i]].noise, least));
      for (std::size_t p = 0; p < parts.size(); ++p)
        measured[p].push_back({ranks[i], span_of(parts[p][i]), made.noise[i]});
    }
    const bool open = !(kalman.density > 0);
    kalman.density = chosen_density(kalman, measured, layout_.dt);
    const auto [settled, reach] = settled_reach(kalman, ranks, made.noise, layout_.dt, 0);
    made.method = settled;
    made.reach = reach;
    const SmoothedMotion motion = kalman_smoother(measured[0], layout_.dt, kalman);
    for (const int rank : wanted) made.derivatives.push_back(rank - ranks.front());
    made_.push_back(made);
    std::string sources;
    for (const std::size_t channel : channels) append_item(sources, given[channel].name);
    for (const int rank : wanted) {
      const auto own = std::find(ranks.begin(), ranks.end(), rank);
      const auto in_place_of =
          own == ranks.end() ? std::optional<std::size_t>() : channels[static_cast<std::size_t>(own - ranks.begin())];
      const VectorXd std = motion.std.col(rank - ranks.front());
      place(std::string(1, "yva"[rank]) + suffix, rank, given[in_place_of.value_or(channels[0])], in_place_of,
            std::sqrt(std.array().square().mean()),
            "of " + sources + " by " + kalman_words(kalman, motion) + (open ? sample_words() : ""));
    }
  }

  /// Puts a channel in place of a measured one or at the end of the list, and tells the last of made_ where.
  void place(const std::string& name, int rank, const Channel& source, std::optional<std::size_t> in_place_of,
             double noise, const std::string& derivation) {
    Channel channel = in_place_of ? source : Channel{};
    channel.name = name;
    channel.unit = in_place_of ? source.unit : motion_unit(source.unit, rank);
    channel.noise = noise;
    channel.derived = !in_place_of;
    channel.derivation = derivation;
    made_.back().places.push_back(in_place_of.value_or(layout_.channels.size()));
    if (in_place_of)
      layout_.channels[*in_place_of] = channel;
    else
      layout_.channels.push_back(channel);
  }

  const RowSource& source_;
  RowSource::Layout& layout_;
  const StreamOptions& options_;
  std::size_t measured_;
  std::vector<std::optional<Spectrum>> spectra_;
  std::vector<bool> still_;
  std::map<std::size_t, SmoothingSpline> splines_;
  std::vector<BlockwiseChannels> made_;
};

}  // namespace

MatrixXd BlockwiseChannels::values(const std::vector<VectorXd>& columns, double dt) const {
  MatrixXd out = MatrixXd::Zero(columns[from[0]].size(), static_cast<Index>(derivatives.size()));
  if (still) return out;
  if (const auto* kalman = std::get_if<KalmanSmoother>(&method)) {
    std::vector<Measurement> measured;
    for (std::size_t i = 0; i < from.size(); ++i) measured.push_back({ranks[i], span_of(columns[from[i]]), noise[i]});
    const SmoothedMotion motion = kalman_smoother(measured, dt, *kalman);
    for (Index k = 0; k < out.cols(); ++k) out.col(k) = motion.values.col(derivatives[static_cast<std::size_t>(k)]);
    return out;
  }
  for (Index k = 0; k < out.cols(); ++k)
    out.col(k) =
        differentiate(span_of(columns[from[0]]), dt, noise[0], derivatives[static_cast<std::size_t>(k)], method).values;
  return out;
}

std::vector<BlockwiseChannels> derive_blockwise(const RowSource& source, RowSource::Layout& layout,
                                                const StreamOptions& options, const Progress& progress) {
  Deriver deriver(source, layout, options);
  deriver.look(progress);
  return deriver.run();
}

}  // namespace lunid
