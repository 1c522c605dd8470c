// Lidars that measure too long, or too short, where their beam meets a plate at a slant.
#pragma once

#include "server/calib/joint/explained.h"

namespace rigcal::calib::joint {

// A beam that meets a surface at a slant is drawn out, and where in it a lidar takes its range is the lidar's own affair
// (Soudarissanane et al. 2011): `b 2 (1 - cos i)` at an incidence of i, none head-on, b at 60 degrees. b of each lidar is
// a random effect of a variance that the session itself tells, max(0, b^2 - var(b)) of b estimated freely (restricted
// maximum likelihood of one effect): zero in most sessions of a lidar without it, and then nothing changes.
[[nodiscard]] Explained WithSlants(Explained now);
// Those of four sigmas and more, by lidar.
[[nodiscard]] std::vector<SlantBias> SlantsTold(const SessionProblem& problem, const Refined& refined);

}  // namespace rigcal::calib::joint
