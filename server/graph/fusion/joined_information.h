// Information of two measurements of one pose together. What neither sees is open in their sum too: each leaves its
// direction open as noise has turned it, and a plain sum would know a little of every direction, the more the more
// measurements there are.
#pragma once

#include "server/graph/solve/observability.h"

namespace rigcal::graph {

// A + B, both on the right tangent of the same pose, in metres and radians; none along directions that both leave open,
// or that they see only because noise turns them against each other (three times `noise_rad`, as Observe has it).
// `length_m` makes metres and radians comparable; not positive: 1 m.
[[nodiscard]] Matrix6d JoinedInformation(const Matrix6d& A, const Matrix6d& B, double noise_rad, double length_m);

}  // namespace rigcal::graph
