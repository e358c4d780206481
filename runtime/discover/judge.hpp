#pragma once
// How candidates are compared: a likelihood with the noise's colour, and free runs over left-out blocks.
#include <tuple>

#include "discover/candidate.hpp"

namespace lunid {

/// The colour of a candidate's residual: means over rows down to six times the motion's upper frequency, then an
/// autoregression chosen by BIC. White residuals are left as they are.
Whitening residual_colour(const Study& study, const Candidate& candidate);

inline constexpr int judge_iterations = 30;  ///< of a fit that is judged to the end

/// Refits under the whitening and fills whitened, innovations, likelihood_cost and log_likelihood. candidate.fit
/// becomes the whitened fit, or a plain one where the whitened free run is clearly worse. `force_noise`: as FitOptions
/// has it; a first look does without.
void judge(const Study& study, Candidate& candidate, const Whitening& whitening, int iterations = judge_iterations,
           bool force_noise = true);

/// The left-out part that a row belongs to: three pieces all over the record each, so that a drift does not fall into
/// one.
int part_of(Eigen::Index row, Eigen::Index rows, int parts);

/// Sum of squares and root mean square of a fit's plain residual [m] ([N] with imposed motion), whatever its whitening;
/// of several coordinates weighted (Study::weights).
double squared_error(const FitResult& fit);
double rms_error(const FitResult& fit);

/// Columns of records, one after another.
Eigen::VectorXd join(const std::vector<Eigen::VectorXd>& parts);

/// Fits anew without each of options->blocks interleaved parts of the training records, runs freely over them and fills
/// left_out, left_out_gap (leave_out.cpp).
void run_left_out(const Study& study, Candidate& candidate);

/// What a candidate's unknowns take off its log likelihood on so many rows, as in Schwarz' criterion (1978, Ann.
/// Statist. 6, 461): half a parameter's logarithm of all rows, and half of those of a run for each first value of an
/// internal state there. Of hundreds of short runs these are more than the parameters. First values that the motion
/// soon forgets, or that many elements share, cost no more than what a record can tell of them: half the logarithm of
/// the determinant of their information, when each was beforehand as uncertain as its state is spread over the run, and
/// half a unit each for the noise that they follow.
double price_of_unknowns(const Candidate& c, double rows);
double bic(const Candidate& c);

/// p-value that `larger` (more parameters, same whitening) is no better than `smaller`: F-test on the whitened costs,
/// or on other squared errors of the same models on so many rows.
double improvement_p_value(const Candidate& smaller, const Candidate& larger);
double improvement_p_value(const Candidate& smaller, const Candidate& larger, double smaller_cost, double larger_cost,
                           double rows);

/// A p-value of one of so many tries (Bonferroni).
double corrected(double p_value, int tried);

/// What is simpler comes first: fewer parameters, fewer effects, a faulty sensor or input before physics.
std::tuple<int, std::size_t, int> simplicity(const Candidate& c);

/// False where all coefficients that `larger` has beyond `smaller` are within two standard deviations of zero and take
/// the force with them there (of bristles the spring stays, without their damping), or another parameter is that does
/// (a hidden mass): the smaller would do as well, had its own fit ended there, whatever the p-value says.
bool told_from_zero(const Study& study, const Candidate& larger, const Candidate& smaller);

/// False where the force of one of its names along the motion, its size told by coefficients, is less than one standard
/// deviation of that size: it and another term grow against each other without end (c*abs(v)^p beside c*v, p near 1),
/// and what they leave between them is of another law than the name's.
bool sizes_are_told(const Study& study, const Candidate& named);

/// Parameters of the baseline that are positive by its own fit and, by so many deviations, negative beside the names;
/// or negative and many times as large as they surely were: a name takes back what they do. Not what holds a number of
/// a named entry too (Effect::twins): c of a system that swings by itself.
std::vector<Eigen::Index> turned_negative(const Candidate& baseline, const Candidate& named, double deviations = 3);

/// How many of the numbers that its entries brought are as far from zero as chance brings them with at least this
/// probability, or are not seen at all.
std::size_t added_near_zero(const Candidate& c, double level);

/// False where all that `larger` has beyond `smaller` are coefficients whose force along the motion is less than a
/// thousandth of the force that acts: a motion that amplifies small differences (several wells) may ask for it, but it
/// names nothing that an engineer would add. True of entries that have other parameters.
bool carries_force(const Study& study, const Candidate& larger, const Candidate& smaller);

/// z-score from which on a set is rejected against another: 1 %, one-sided.
inline constexpr double vuong_level = 2.33;
/// z-score of "a is closer to the truth than b" from the innovations (Vuong 1989, Econometrica 57, 307), Schwarz'
/// correction for the number of parameters, long-run variance by Newey-West.
double vuong_z(const Candidate& a, const Candidate& b);

/// A squared whitened error that is a tenth and fifty nats above that of a set which leaves no more than the sensor's
/// noise (rms of its plain residual) is too much, however few passages tell the two apart: Vuong's test takes a passage
/// through resonance for one observation.
bool stays_above_noise(const Study& study, double cost, double best, double rows, double best_rms);
/// `c` is rejected against `best`, by Vuong's test or because it stays above the noise.
bool fits_worse(const Study& study, const Candidate& c, const Candidate& best);

/// p-value that the left-out error of `after` is not below that of `before` (block bootstrap).
double left_out_p_value(const Study& study, const Candidate& before, const Candidate& after);

/// Least relative drop of the left-out gap that counts. Where the better model's error is what the sensor leaves, the
/// options' least gain; where it stays far above it (input noise, drift, a rough model), five times that: small gains
/// there come from patching what is no function of the motion.
double required_gain(const Study& study, double gap_after);

/// A gap of 1 is that of a motion which is predicted as zero. A model that is worse, or cannot be run, counts as none:
/// nobody earns by what a run that explodes leaves.
double at_most_all(double gap);

/// Share of the excess of a gap, at_most_all(), over its floor (squared) that a better model closes.
double closed_share(double before, double after, double floor);
/// The same of two fits' errors over the training records, over the sensor's noise.
double closed_share(const Study& study, const Candidate& before, const Candidate& after);

/// Block length [rows] for bootstraps: two periods of the motion.
Eigen::Index bootstrap_block(const Study& study);
/// The same of so many rows at another rate.
Eigen::Index bootstrap_block(const Study& study, double dt, Eigen::Index rows);

}  // namespace lunid
