// What lidars, lenses and boards do beyond what they are taken for: ranges that err at a slant, rays that do not meet
// in one point, plates that are bent.
#pragma once

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

constexpr double kAnyBend_m = 0.05;                     // as good as not held
constexpr double kSureBend = 14.16, kToldBend = 22.06;  // squared sigmas of three numbers: once in 400 times, in 16,000

// Of a lidar: a beam that meets a surface at a slant is drawn out, and where in it a lidar takes its range is the
// lidar's own affair (Soudarissanane et al. 2011): `b 2 (1 - cos i)` at an incidence of i, none head-on, b at 60
// degrees. Of a lens: its entrance pupil lies the further ahead, the further from the axis it is looked into (Gennery
// 2006): `b 2 sin^2` of the angle, b at 45 degrees, so that what is near is seen elsewhere than what is far. Of a
// board: its points lie off their plane by `b . q(x, y)`, b = (xx, xy, yy), q of BendShape. Each b is a random effect,
// N(0, sigma^2 I), of a variance that the session itself tells: the likeliest by b estimated freely, N(b; 0, sigma^2 I
// + cov(b)) (restricted maximum likelihood of one effect).
//
// The problem with every effect that is held as good as free.
[[nodiscard]] SessionProblem WithEffectsFree(SessionProblem problem);
// Takes it out of those that surely have it: where chance would make as much of nothing once in 400 times (three sigmas
// of one number) b becomes unknowns, pulled to zero by sigma. What lenses may do beyond their models counts as chance
// here.
[[nodiscard]] Explained WithInstrumentEffects(Explained now);
// Of the others: what their sigma adds to the unknowns of the layout, as a misfit of a lens that is not told does; the
// poses stay those of least squares. Empty: nothing.
[[nodiscard]] Eigen::MatrixXd CovarianceByInstruments(const Explained& last);
// Those that chance would make once in 16,000 times (four sigmas of one number), by lidar, camera and board.
// `by_fields`: what lenses may do to the unknowns beyond their models (CovarianceByFields): a lens that bends its
// pictures bends the boards in them.
[[nodiscard]] std::vector<SlantBias> SlantsTold(const SessionProblem& problem, const Refined& refined,
                                                const Eigen::MatrixXd& by_fields);
[[nodiscard]] std::vector<PupilShift> PupilShiftsTold(const SessionProblem& problem, const Refined& refined,
                                                      const Eigen::MatrixXd& by_fields);
[[nodiscard]] std::vector<BoardBend> BendsTold(const SessionProblem& problem, const Refined& refined,
                                               const Eigen::MatrixXd& by_fields);

}  // namespace rigcal::calib::joint
