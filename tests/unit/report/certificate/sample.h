// A certificate's input: sessions, a rig, a policy, and degrees of freedom behind one sensor, whose sigma is 0.28 mm
// and 0.0321 deg at worst. It is in use.
#pragma once

#include "server/report/certificate/content.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {

inline ReportInput CertificateSample() {
  ReportInput input = SampleReport();
  input.revision.policy = PolicyInForce{};
  input.revision.policy->policy.all.tolerance_m = 0.001;
  input.calibrated_at = *ParseIso("2026-01-30T09:30:00Z");
  SensorPose& right = input.revision.solution.poses[1];
  right.by_jackknife = true, right.dof = 10.0;
  input.sessions = {{SessionId(Sha256Of("session").str()),
                     *input.calibrated_at,
                     "Ada",
                     "mars-mapper",
                     {"board: checkerboard 9 x 6, 25 mm"},
                     20}};
  input.sessions[0].conditions = {{"site", "hall 3"}, {"temperature_deg_c", "21"}};
  const Word word{*ParseIso("2026-02-01T08:00:00Z"), "Eve", "checked"};
  input.approval = Approval{RevisionState::kApproved, Decision{1, input.number, "approved", word}};
  return input;
}

}  // namespace rigcal::report
