// Cameras whose given intrinsics are not those of their lens: two lines exchanged, numbers of another focus or picture
// size, of the lens that was there before. In poses that looks like turned cameras, which nobody would see.
#pragma once

#include <optional>

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

// Cameras, by index, whose given intrinsics contradict what the session says of them, beyond what chance and the
// scatter of its groups make. d = refined - given and C its covariance: d ~ N(0, S - C), S the given covariance; of
// intrinsics without a sigma d and C are those of one step with all of them free, d ~ N(0, C).
[[nodiscard]] std::vector<std::size_t> ContradictedLenses(const SessionProblem& problem, const Refined& refined);
// From the refined state on the intrinsics of these are as good as not given.
[[nodiscard]] SessionStart WithLensesFree(SessionStart start, const Refined& refined,
                                          const std::vector<std::size_t>& cameras);
// Squares of what pulls at lenses, in sigmas: of -2 log likelihood what given intrinsics have.
[[nodiscard]] double LensPull(const SessionProblem& problem, const SessionState& state);
// How far the given intrinsics project elsewhere than those of `freed`, and whose they are instead, if another camera
// of `before` was given them.
[[nodiscard]] std::vector<ContradictedLens> ContradictedLensesTold(const Explained& before, const Explained& freed,
                                                                   const std::vector<std::size_t>& cameras);
// Of those the ones whose given intrinsics contradict the numbers that `last`, in which they are free, ends with:
// d ~ N(0, S + C). `given`: the problem with its lenses as given.
[[nodiscard]] std::vector<ContradictedLens> StillContradicted(const std::vector<ContradictedLens>& told,
                                                              const SessionProblem& given, const Explained& last);

}  // namespace rigcal::calib::joint
