// As found: the calibration in use is tested against a session's own estimate, before poses are updated by the session.
//
// Per sensor and axis, t = change / sigma with C_session + C_in_use + tau^2 for its covariance, a Student's t of
// Welch's degrees of freedom, at most those of tau^2. tau^2, what sensors scatter by from visit to visit, is in what a
// revision tells (session_fusion.h) and not added once more; where one visit tells nothing of it, it is that of the
// other robots of the rig model, or else assumed. The odds alpha of a false alarm are those of the whole session: each
// of m axes is tested at alpha / m (Bonferroni; Dunn 1961), which holds however the axes hang together. README.md has
// the method.
#pragma once

#include <set>

#include "server/fleet/as_found/known_poses.h"
#include "server/fleet/as_found/partly_known.h"
#include "server/fleet/assess.h"
#include "server/model/approval/policy.h"
#include "server/model/graph/graph.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::fleet {

// Of the odds alpha, the part that goes to rates of drift; the rest is that of steps.
inline constexpr double kAlphaOfRates = 0.1;

struct AsFoundInput {
  KnownPoses in_use;                    // of a revision: covariance of places on a visit
  KnownPoses session;                   // its own estimate
  KnownPoses left;                      // of the revision that is made with the session; its covariance does not matter
  std::set<SensorId> moved_on_purpose;  // since `in_use`
  double alpha = kAsFoundAlpha;
  // What sensors are taken to scatter by from visit to visit (1 sigma per axis) where fewer than two visits are in use
  // and neither the calibration in use nor `pooled_scatter` has it from other robots.
  PoseLimit assumed_scatter = kDefaultMovedMin;
  PooledScatter pooled_scatter = {};  // of robots with the reference that is in use
  // Sensors that one side or both know in part only, told from the reference in use: tested along what both measured.
  std::vector<PartOfBoth> parts = {};
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
// over the visits that tell it and `found.relative_to`, per axis, weights 1 / (C_visit + tau^2). Its sigma is by what
// the visits scatter by about the line, as a drift is in tau too, and at least by what they err by. Needs three visits,
// not all of one time. `now`: the newest revision's poses, from which changes are counted, and tau.
void AddDriftRates(const std::vector<VisitPoses>& visits, const KnownPoses& now, AsFound& found);

// A place that goes on changing, beyond chance and by more than is allowed.
struct Drifting {
  Vector6d per_30_days = Vector6d::Zero();  // of the axes that do, m and rad; the others zero
  double sigmas = 0.0;                      // of the surest of these
  PoseLimit smallest;  // in 30 days: what these visits would have told with kAsFoundPower, of any axis
};
// From four visits on: each of the axes that were tested at its part of kAlphaOfRates alpha, with two degrees of
// freedom less than there are visits, as the rate's sigma is what they scatter by about their line. Nothing where no
// axis drifts.
[[nodiscard]] std::optional<Drifting> DriftingOf(const SensorFound& sensor, const AsFound& found,
                                                 const PoseLimit& least_per_30_days);
// "right drifts by 1.2 mm in 30 days (8.3 sigma, 9 visits since 3 Sep 2026; the smallest drift that these visits could
// have told is 0.5 mm, 0.02 deg in 30 days)"
[[nodiscard]] std::string DriftingText(const SensorFound& sensor, const Drifting& drifting);

// Who was found unchanged but sat elsewhere by what findings tell of the same sessions, is not told apart from what
// sensors scatter by: the test lacks the power. Where relative_to did, that is all that were found unchanged. The
// largest of each sensor counts.
void MarkElsewhere(const std::vector<SensorMovedBetween>& elsewhere, AsFound& found);

// "As found (session of 2026-11-03, against revision 2): left unchanged; right moved 1.2 mm, 0.04 deg (5.1 sigma);
// smallest change this session could have seen: 0.6 mm, 0.02 deg."
[[nodiscard]] std::string AsFoundText(const AsFound& found, const SessionTimes& captured_at);

}  // namespace rigcal::fleet
