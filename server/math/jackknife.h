// Delete-one-block jackknife on SE(3) (paper, section III-C, with the missing square restored).
#pragma once

#include <vector>

#include "server/math/se3.h"

namespace rigcal {

// C_jack = (m-1)/m sum (d_i - mean)(d_i - mean)^T, d_i = Log(T^-1 T_(i)). Needs m >= 2 block vectors.
[[nodiscard]] Matrix6d JackknifeCovariance(const std::vector<Vector6d>& d);

// What the blocks show, held against the model, which is never undercut (shrunk_scatter.h). Invariant under a change of
// frame; where C_model is singular, the blocks must lie along it. m >= 2 block vectors.
[[nodiscard]] Matrix6d JackknifeOrModel(const std::vector<Vector6d>& d, const Matrix6d& C_model);

}  // namespace rigcal
