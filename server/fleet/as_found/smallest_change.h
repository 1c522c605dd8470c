// The smallest change that a test would have told with kAsFoundPower.
//
// What is tested is d = D + e against the limit L sigma, sigma as told. That limit is a length by then, the same for
// the change that there was and for one that there might have been; what D needs beyond it is what e may take from it,
// and e / sigma is a t of nu degrees of freedom where sigma is an estimate: D = (L + t_.95,nu) sigma. (By the
// noncentral t, D would be a multiple of the true sigma, which nobody has; taken of an estimate it is too large.)
#pragma once

#include "server/fleet/as_found/change_seen.h"

namespace rigcal::fleet {

// Sigmas from which on an axis has changed; `dof` behind its sigma, 0: known.
[[nodiscard]] double LimitInSigmas(double alpha_of_axis, double dof);
// Sigmas beyond `limit` that a change needs to be told all the same.
[[nodiscard]] double BeyondLimitInSigmas(double dof);

// Of a row of `seen`, m or rad. Of a variance that nobody told (ChangeSeen::assumed) the limit is what it is, but it
// need not be what visits scatter by: e is then by what `still`, sensors that did not move, show of it in this session,
// the row's own left out. Infinite: a change of any size may stay unseen.
[[nodiscard]] double SmallestChange(const ChangeSeen& seen, Eigen::Index row, const std::vector<SensorId>& still,
                                    double alpha_of_axis);

}  // namespace rigcal::fleet
