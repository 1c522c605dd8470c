// Relative poses of two sensors that are known from their clouds alone (NDT), held against all that was seen besides.
#pragma once

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

// Leaves out one relative pose after the other, the one first that is furthest beyond chance, and refines anew: where
// two clouds were laid on each other wrongly, poses would go astray by what that is wrong, and the noise of all else
// would be taken for larger instead. With e the residual, Omega its information of nu degrees of freedom, C the
// covariance of the poses with it in, and B what lenses, lidars and boards may do to them beyond their models, z =
// Omega^1/2 e has the variance I - M_C + M_B, M_X = Omega^1/2 J X J^T Omega^1/2 (OddsOfResidual). Told below kMovedOdds
// by Hotelling's T^2, corrected for their number.
[[nodiscard]] Explained WithoutContradictedPairs(Explained now, SessionEstimate& told);

// Of a residual z of variance I - leverage + beside to be so far off by chance, `dof` behind its information (0:
// known). What nothing else tells, axes of leverage 1, is not judged.
[[nodiscard]] double OddsOfResidual(const Vector6d& z, const Matrix6d& leverage, const Matrix6d& beside, int dof);

}  // namespace rigcal::calib::joint
