// Starting values of A_k X = Z B_k in closed form.
#pragma once

#include <vector>

#include "server/math/se3.h"

namespace rigcal::calib {

// The same motion as each of the two sensors saw it: T_a_before_a_after, T_b_before_b_after; A X = X B.
struct MotionPair {
  Se3 A, B;
};

// X by Park & Martin (1994): the rotation that turns the rotation vectors of B into those of A, then the translation by
// least squares. Where the rotations share one axis, or there are none, what they leave open of the rotation is tried
// in steps, and the translation is the shortest one. Never empty unless `motions` is.
[[nodiscard]] std::vector<Se3> StartsOf(const std::vector<MotionPair>& motions);

// X = T_a_b, Z = T_world-of-a_world-of-b, of A_k X = Z B_k.
struct ClosedForm {
  Se3 X, Z;
};
// From poses A_k, B_k of the same instants, side by side: the rotation of X from the motions between all of them (Park
// & Martin), that of Z as their mean, then both translations at once by least squares (Shah 2013). All of it is told
// only by turns about different axes.
[[nodiscard]] ClosedForm ClosedFormOf(const std::vector<Se3>& a, const std::vector<Se3>& b);

}  // namespace rigcal::calib
