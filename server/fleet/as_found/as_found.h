// As found: the calibration in use is tested against a session's own estimate, before poses are updated by the session.
//
// Per sensor and axis, t = change / sigma with C_session + C_in_use + tau^2 for its covariance, a Student's t of
// Welch's degrees of freedom, at most those of tau^2. tau^2, what sensors scatter by from visit to visit, is in what a
// revision tells (session_fusion.h) and not added once more; where one visit tells nothing of it, it is that of the other
// robots of the rig model, or else assumed. The odds alpha of a false alarm are those of the whole session:
// each of m axes is tested at alpha / m (Bonferroni; Dunn 1961), which holds however the axes hang together. README.md
// has the method.
#pragma once

#include <set>

#include "server/fleet/as_found/known_poses.h"
#include "server/fleet/assess.h"
#include "server/model/approval/policy.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::fleet {

struct AsFoundInput {
  KnownPoses in_use;                    // of a revision: covariance of places on a visit
  KnownPoses session;                   // its own estimate
  KnownPoses left;                      // of the revision that is made with the session; its covariance does not matter
  std::set<SensorId> moved_on_purpose;  // since `in_use`
  double alpha = kAsFoundAlpha;
  // What sensors are taken to scatter by from visit to visit (1 sigma per axis) where fewer than two visits are in use and
  // neither the calibration in use nor `pooled_scatter` has it from other robots.
  PoseLimit assumed_scatter = kDefaultMovedMin;
  PooledScatter pooled_scatter = {};  // of robots with the reference that is in use
};
// From `why_not` on, without rates and text. References may be different ones. Told in the frame of the reference in
// use, unless that is what moved: then in that of the sensor that is best known against it.
[[nodiscard]] AsFound TestAsFound(const AsFoundInput& input);

// A session's poses of the sensors that still sit as they did then.
struct VisitPoses {
  Stamp captured_at;
  KnownPoses poses;
};
// Adds to each sensor that was tested how fast its place changes: weighted least squares of a straight line in time
// over the visits that tell it and `found.relative_to`, per axis, weights 1 / (C_visit + tau^2). Needs three visits,
// not all of one time. `now`: the newest revision's poses, from which changes are counted, and tau.
void AddDriftRates(const std::vector<VisitPoses>& visits, const KnownPoses& now, AsFound& found);

// "As found (session of 2026-11-03, against revision 2): left unchanged; right moved 1.2 mm, 0.04 deg (5.1 sigma);
// smallest change this session could have seen: 0.6 mm, 0.02 deg."
[[nodiscard]] std::string AsFoundText(const AsFound& found, const SessionTimes& captured_at);

}  // namespace rigcal::fleet
