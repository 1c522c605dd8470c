// Lidars that measure too long, or too short, where their beam meets a plate at a slant.
#pragma once

#include "server/calib/joint/explained.h"

namespace rigcal::calib::joint {

// A beam that meets a surface at a slant is drawn out, and where in it a lidar takes its range is the lidar's own affair
// (Soudarissanane et al. 2011): `b 2 (1 - cos i)` at an incidence of i, none head-on, b at 60 degrees. b of each lidar is
// a random effect, N(0, sigma^2), of a variance that the session itself tells: sigma^2 = max(0, b^2 - var(b)) of b
// estimated freely (restricted maximum likelihood of one effect).
//
// Takes it out of those lidars that surely have it: from three sigmas on b is one more unknown, pulled to zero by sigma.
[[nodiscard]] Explained WithSlants(Explained now);
// Of the others: what their sigma adds to the unknowns of the layout, as a misfit of a lens that is not told does; the
// poses stay those of least squares. Empty: nothing.
[[nodiscard]] Eigen::MatrixXd CovarianceBySlants(const Explained& last);
// Those of four sigmas and more, by lidar.
[[nodiscard]] std::vector<SlantBias> SlantsTold(const SessionProblem& problem, const Refined& refined);

}  // namespace rigcal::calib::joint
