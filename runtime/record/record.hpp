#pragma once
// A measured record: channels over one even time base, in SI, with the noise of each channel.
#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "expr/error.hpp"
#include "expr/expr.hpp"

namespace lunid {

/// What a signal does between its samples: part of the model (docs/methods.md).
enum class Interpolation { hold, linear, cubic, band_limited };
inline constexpr std::array every_interpolation{Interpolation::linear, Interpolation::cubic,
                                                Interpolation::band_limited, Interpolation::hold};
std::string to_string(Interpolation);
/// Of "hold", "linear", "cubic" or "band_limited". Throws InputError with the choices.
Interpolation interpolation_named(std::string_view word);

/// One channel of a record. Names are the language's: F y v a (y_reference and other extra columns keep their
/// header).
struct Channel {
  std::string name;
  std::string unit;         ///< SI unit after conversion ("m"), "" when none was given
  std::string source;       ///< header as found in the file
  std::string source_unit;  ///< unit as found ("mm")
  Eigen::VectorXd values;
  double noise = 0;      ///< standard deviation of the channel's own noise, estimated (noise_level)
  bool derived = false;  ///< true for what was computed from other channels
  Interpolation between = Interpolation::linear;  ///< what it does between its samples
  /// Of a signal that was made: its value at any time t [s]. What `values` have beyond it is interpolated. Else empty.
  Expr formula{};
  std::string derivation{};  ///< how it was computed from other channels; "" of one that was not
};

/// A record has no fewer rows.
inline constexpr Eigen::Index least_rows = 6;
/// Throws InputError (Fault::data) for fewer in a file or a record of that name.
void check_rows(Eigen::Index rows, const std::string& name);

/// Value type; copies and windows share the columns.
class Record {
 public:
  Record() = default;
  /// Throws InputError (Fault::data) when channels differ in length, names repeat, or there are no rows.
  Record(std::string name, double t0, double dt, std::vector<Channel> channels);

  const std::string& name() const { return name_; }  ///< the file's path, as given
  Eigen::Index rows() const { return count_; }
  double dt() const { return dt_; }                                          ///< [s]
  double start() const { return t0_ + dt_ * static_cast<double>(first_); }   ///< [s] of the first row of the window
  double duration() const { return dt_ * static_cast<double>(count_ - 1); }  ///< [s]
  double time(Eigen::Index row) const { return start() + dt_ * static_cast<double>(row); }
  bool has(std::string_view channel) const;
  /// Values of a channel within the window. Throws InputError naming the channels that there are.
  std::span<const double> operator[](std::string_view channel) const;
  const Channel& channel(std::string_view channel) const;
  const std::vector<Channel>& channels() const { return *channels_; }
  const std::vector<std::string>& warnings() const { return warnings_; }  ///< what reading found (rounded time, ...)
  void warn(std::string text) { warnings_.push_back(std::move(text)); }
  const std::vector<std::string>& history() const { return history_; }  ///< what was done to it since it was read
  void note(std::string text) { history_.push_back(std::move(text)); }
  /// Takes the warnings, the history and the part of the record that this one was made of.
  void take_notes(const Record& from);
  /// Its file has a column of the time without a unit: seconds were taken.
  bool time_without_unit() const { return time_without_unit_; }
  void note_time_without_unit() { time_without_unit_ = true; }
  /// Times on either side of rows that were missing and are interpolated [s].
  void note_gaps(std::vector<std::pair<double, double>> gaps) { gaps_ = std::move(gaps); }

  /// The parts between gaps of three rows and more that were interpolated, where motion and force are invented; those
  /// of fewer than `least` rows are left out, with a warning. The record itself where there is no such gap. Throws
  /// InputError (Fault::data) where no part is that long.
  std::vector<Record> pieces(Eigen::Index least = 50) const;
  int part() const { return part_; }  ///< which of pieces() this is, from 1; 0: the whole record
  /// ", part 2 of 3, from t = 4.5 s" of one of several pieces; else empty.
  std::string words_of_part() const;

  /// Rows with from <= t <= to [s]. Throws InputError when fewer than 6 rows are left, saying what time the
  /// record has.
  Record window(double from, double to) const;
  /// Rows [first, first + count) of this window.
  Record slice(Eigen::Index first, Eigen::Index count) const;
  /// This record with a channel added or replaced (length of the whole window).
  Record with(Channel channel) const;

 private:
  std::string name_;
  double t0_ = 0, dt_ = 1;
  Eigen::Index first_ = 0, count_ = 0;
  std::shared_ptr<const std::vector<Channel>> channels_;
  std::vector<std::string> warnings_, history_;
  std::vector<std::pair<double, double>> gaps_;
  int part_ = 0, parts_ = 0;
  bool time_without_unit_ = false;
};

/// "t=time" or "y=disp [mm]" or "F=load (kN)": channel, header in the file, unit (optional).
struct ColumnMap {
  std::string channel;
  std::string header;
  std::string unit;  ///< "" : take the header's, else SI
};
/// Reads `--columns "t=time,y=disp [mm],F=load [kN]"`. Throws InputError (Fault::usage).
std::vector<ColumnMap> parse_columns(std::string_view text);
/// One of these: channel "y" or "displacement", text "disp [mm]".
ColumnMap parse_column(std::string_view channel, std::string_view text);

struct ReadOptions {
  std::vector<ColumnMap> columns;  ///< empty: t F y v a by name, units from the headers
  bool resample = false;           ///< a really uneven time base is resampled to its median step
  double interval = 0;             ///< [s] between rows, in place of a time column; 0: none
  /// MAT and HDF5: the name of a number in the file that is the interval [s], or the rate [Hz]; "": none.
  std::string interval_name{}, rate_name{};
};

/// Reads a record from a MAT file (its name ends in .mat), an HDF5 file (by its first bytes) or else a CSV file.
Record read_record(const std::string& path, const ReadOptions& options = {});
/// Reads a CSV file: separator , ; or tab (found), comments with #, header with names and units ("y [mm]", "F
/// (kN)"). Derives v and a when absent (derive_motion) and estimates each channel's noise. Throws InputError
/// (Fault::data) with file and line: missing or empty file, decimal comma, text or NaN in a number column, a
/// row of another length, two columns of one name, time that runs backwards or is uneven, fewer than 6 rows.
Record read_csv(const std::string& path, const ReadOptions& options = {});
/// Writes t and the channels in SI with units in the header; atomically; reads back to the same doubles.
void write_csv(const Record& record, const std::string& path);

/// Factor to SI and the SI unit of "mm", "kN", "in", "lbf", "deg", "g", "ms", "V", "mm/s", "m/s^2" ...;
/// nullopt when unknown.
struct SiUnit {
  double factor;
  std::string unit;
};
std::optional<SiUnit> si_unit(std::string_view unit);

// ---- derivatives.cpp ----
/// Savitzky-Golay smoothing (derivative = 0) or derivative of an evenly sampled signal: polynomial `order`
/// over `2 * half_width + 1` samples, one-sided fits at the ends. (Savitzky & Golay 1964, Anal. Chem. 36,
/// 1627.)
struct SavitzkyGolay {
  int half_width = 5;
  int order = 3;
};
Eigen::VectorXd savitzky_golay(std::span<const double> x, double dt, int derivative, const SavitzkyGolay& options);
/// The window that a signal of this noise calls for: the widest whose smoothing bias stays below the noise
/// that it leaves (order 3 or 5; at least order + 2 samples).
SavitzkyGolay choose_savitzky_golay(std::span<const double> x, double noise, int derivative);
/// Standard deviation of the white part of the noise: the lowest level of the Welch spectrum over broad
/// bands, taken over the whole bandwidth. 0 for a constant signal.
double noise_level(std::span<const double> x);
/// The same of a signal that jumps now and then (a force of friction or of stops), whose spectrum does not come down to
/// its noise: by the median size of its differences of orders 1 to 5, where rare jumps do not count.
double noise_between_jumps(std::span<const double> x);
/// Signals that drive a motion, of the same rows as it.
using Drives = std::vector<std::span<const double>>;
/// Standard deviation of noise of any colour, from what a model leaves of a signal and what it makes of it, of the same
/// rows: the spectrum of the former without what follows the drives linearly, of which no band counts for more than the
/// highest of those where the model has next to no power. 0 where it has power in all bands.
double noise_beside(std::span<const double> left, std::span<const double> model, const Drives& drives = {});
/// The part of a signal's power that follows the drives linearly, by its coherence with each (Bendat & Piersol 2010,
/// chapter 6), of unrelated ones 0 in the mean. 0 without drives and for less than 64 rows.
double driven_part(std::span<const double> left, const Drives& drives);
/// This record with smoothed `v` and `a` added where absent (marked derived); the same for each numbered coordinate (y1
/// v1 a1, y2 ...) and for a base (yb vb ab). Needs one of them: has_motion().
Record derive_motion(const Record& record);
/// What was measured of a coordinate ("", "1", "2" ...): its displacement y or, where that was derived, its velocity v
/// or its acceleration a; y where none was measured. What an integral has lost or added no model can be held against.
std::string measured_channel(const Record& record, const std::string& suffix = "");
bool has_motion(const Record& record);
/// The dominant angular frequency [rad/s] of a signal: the power-weighted centre of its spectrum's largest
/// peak.
double dominant_frequency(std::span<const double> x, double dt);

}  // namespace lunid
