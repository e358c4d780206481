#pragma once
// Dynamic time warping: how far apart are two curves, whatever the pace at which they are run through?
#include <Eigen/Core>
#include <span>

namespace lunid {

/// The least sum of Euclidean distances between rows of a and of b over all pairings that begin at the first rows, end
/// at the last and step on by one row of a, of b or of both. `band` >= 0: a row i of a meets rows of b no farther than
/// so many from i (m - 1)/(n - 1), and those that the next row of a needs to go on from (Sakoe & Chiba 1978, IEEE
/// Trans. ASSP 26, 43); < 0: none. Exact, to the last bit: pairings that already cost more than one within a narrow
/// band are left out, and they are most of them where the curves are alike (Herrmann & Webb 2021, Data Min. Knowl.
/// Discov. 35, 2577). FastDTW (Salvador & Chan 2007), which is not exact, would seldom be faster (Wu & Keogh 2020).
/// Throws InputError as check_columns() does, and where the columns are not as many.
double dtw(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b,
           Eigen::Index band = -1);

/// A pairing of rows whose sum of distances is that of dtw(): rows of a and of b, each never falling, from the first of
/// both to the last of both. Of equals the step on in both comes first, then that in a. Takes a byte for each pair of
/// rows within the band; throws InputError beyond 4e8 of them.
struct Pairing {
  Eigen::VectorX<Eigen::Index> a, b;
  double distance = 0;
};
Pairing dtw_pairing(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b,
                    Eigen::Index band = -1);

/// DTW of two phase portraits, displacement and velocity each over its measured standard deviation, per measured row:
/// so many deviations lie between the two on the mean. The thesis has the sum in physical units.
double phase_portrait_distance(std::span<const double> y, std::span<const double> v, std::span<const double> model_y,
                               std::span<const double> model_v, Eigen::Index band = -1);

}  // namespace lunid
