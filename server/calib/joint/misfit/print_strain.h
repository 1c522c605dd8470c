// Boards whose print is stretched in its plane: a printer feeds its paper by another length than it sweeps it.
#pragma once

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

constexpr double kAnyStrain_ratio = 0.05;  // as good as not held
constexpr double kSureStrain = 11.98,
                 kToldStrain = 19.36;  // squared sigmas of two numbers: once in 400, in 16,000 times

// A print's strain e = (xx, yy, xy) moves its points by StrainShape. Where it is not the same in every direction, by
// (xx - yy, 2 xy), surely (chance would make as much of nothing once in 400 times, and lenses may not do it beyond
// their models), all of it becomes an unknown with a pull, N(0, n sigma^2 I) with sigma the length of (xx - yy, 2 xy):
// a print that is wrong by so much from one direction to the other may be as wrong in its size. n boards may have that
// in common, as one printer printed them, so they do not average it away. A print that is larger all over is its scale,
// and not looked for here. A session without one is as it was.
[[nodiscard]] Explained WithPrintStrain(Explained now);
// Those that chance would make once in 16,000 times, by board.
[[nodiscard]] std::vector<PrintStretch> StretchesTold(const SessionProblem& problem, const Refined& refined,
                                                      const Eigen::MatrixXd& by_fields);

}  // namespace rigcal::calib::joint
