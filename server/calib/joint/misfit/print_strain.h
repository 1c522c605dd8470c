// Boards whose print is stretched in its plane: a printer feeds its paper by another length than it sweeps it.
#pragma once

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

constexpr double kAnyStrain_ratio = 0.05;  // as good as not held
constexpr double kSureStrain = 11.98,
                 kToldStrain = 19.36;  // squared sigmas of two numbers: once in 400, in 16,000 times

// A print's strain e = (xx, yy, xy) moves its points by StrainShape. By how much prints are longer one way than
// another: the root mean square, over the boards of which that is sure, of the length of (xx - yy, 2 xy); 0 where it is
// sure of none. Sure: chance would make as much of nothing once in 400 times, and lenses may not do it beyond their
// models. A print that is larger all over is its scale, and not looked for here. What is in `now` of it is not kept.
[[nodiscard]] double PrintStrain_ratio(const Explained& now);
// The strain of every board that is seen becomes an unknown with a pull, N(0, n sigma^2 I) with sigma = `strain_ratio`:
// a print that is wrong by so much from one direction to the other may be as wrong in its size, and one that is not
// surely stretched came from the same printer. The n boards may have that in common, so they do not average it away. Of
// each lens that is given, fx may be off by as much, as before boards held upright that looks alike; so a wrong fx that
// reads as strain, or the other way round, is in the sigmas. 0: as it was.
[[nodiscard]] Explained WithPrintStrain(Explained now, double strain_ratio);
// Those that chance would make once in 16,000 times, by board. `C` of the layout's unknowns.
[[nodiscard]] std::vector<PrintStretch> StretchesTold(const SessionProblem& problem, const Refined& refined,
                                                      const Eigen::MatrixXd& C);

}  // namespace rigcal::calib::joint
