// Relative poses of two sensors that are known from their clouds alone (NDT), held against all that was seen besides.
#pragma once

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

// Leaves out one relative pose after the other, the one first that is furthest beyond chance, and refines anew: where
// two clouds were laid on each other wrongly, poses would go astray by what that is wrong, and the noise of all else
// would be taken for larger instead. With e the residual, Omega its information of nu degrees of freedom and C the
// covariance of the poses with it in and with what lenses, lidars and boards may do beyond their models, leverage M =
// Omega^1/2 J C J^T Omega^1/2: T^2 = sum z_i^2 / (1 - m_i) along the axes of M, z = Omega^1/2 e, which is the residual
// without it over its variance. Told below kMovedOdds by Hotelling's T^2, corrected for their number. What nothing else
// tells (m_i = 1) is not judged.
[[nodiscard]] Explained WithoutContradictedPairs(Explained now, SessionEstimate& told);

}  // namespace rigcal::calib::joint
