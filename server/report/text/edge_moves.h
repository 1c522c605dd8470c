// Measurements of one pair of sensors in two revisions, against each other.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "server/base/stamp.h"
#include "server/formats/documents.h"

namespace rigcal::report {

struct EdgeMove {
  const Edge* before = nullptr;  // nullptr: the pair was not calibrated before
  const Edge* now = nullptr;     // nullptr: it no longer is
  bool measured_again = false;   // else both are the same measurement, and the rest is zero
  // Log(before^-1 now), and of the two independent sigmas; right tangent at b. Zero along axes that one leaves free.
  Vector6d d = Vector6d::Zero(), sigma = Vector6d::Zero();
  std::array<bool, 6> known = {};  // axes that both know
  double in_sigmas = 0.0;          // the largest |d| / sigma of these
};
// Good edges by pair and method: the newest measurement of each revision, by when its session was captured. The
// farthest in sigmas first, then what is in one revision only, then what was not measured again.
[[nodiscard]] std::vector<EdgeMove> EdgeMoves(const formats::RevisionInput& before, const formats::RevisionInput& now,
                                              const std::map<SessionId, Stamp>& captured_at);

}  // namespace rigcal::report
