// READ: what a revision says of the status of its robot, and whether its newest session failed as a whole.
#pragma once

#include <optional>
#include <string>

#include "server/fleet/assess.h"
#include "server/formats/alerts/alert_body.h"
#include "server/formats/documents.h"
#include "server/model/approval/policy_version.h"
#include "server/model/robots/robot_status.h"
#include "server/model/sessions/as_found.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Of a revision in the making: what it tells, and what its newest session found of the calibration in use.
struct StatusOfRevision {
  const formats::RevisionInput& made;
  const PolicyInForce& policy;  // that judged it
  const std::optional<AsFound>& found;
  std::optional<Stamp> calibrated_at;
  std::int64_t max_age_ns = 0;
  const fleet::SessionHeaders& headers;
};
// Dates by drift are learnt from the newest visits of the robots of its rig model and of its own. What of these cannot
// be read any more is logged, and left out.
[[nodiscard]] Result<StatusFacts> FindStatus(storage::Store& store, const StatusOfRevision& revision);

// "site", else "location", of the conditions of the newest session that has one; empty: none has.
[[nodiscard]] std::string SiteOf(const fleet::SessionHeaders& headers);

// That the newest session of the robot failed: no pair of sensors of it is good. Nothing where one is, where pairs
// of it wait, or where it was told before. `revision`: the number of the one that is made.
[[nodiscard]] Result<std::optional<formats::AlertDraft>> FindFailedSession(storage::Store& store,
                                                                           const formats::RevisionInput& made,
                                                                           const fleet::SessionTimes& captured_at,
                                                                           int revision, Stamp now);

}  // namespace rigcal::pipeline
