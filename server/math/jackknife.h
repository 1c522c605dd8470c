// Delete-one-block jackknife on SE(3) (paper, section III-D, with the missing square restored).
#pragma once

#include <vector>

#include "server/math/se3.h"

namespace rigcal {

// C_jack = (m-1)/m sum (d_i - mean)(d_i - mean)^T, d_i = Log(T^-1 T_(i)). Needs m >= 2 block vectors.
[[nodiscard]] Matrix6d JackknifeCovariance(const std::vector<Vector6d>& d);
// ((m-1) C_jack + 7 C_model) / (m+6): shrinks towards the model where blocks are few; invariant under a change of frame.
[[nodiscard]] Matrix6d ShrinkTowardsModel(const Matrix6d& C_jack, const Matrix6d& C_model, int m);
// The share of C_jack in that.
[[nodiscard]] double JackknifeShare(int m);

}  // namespace rigcal
