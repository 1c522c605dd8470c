// The parts of a certificate below its head, in their order.
#pragma once

#include <vector>

#include "server/model/certificate.h"
#include "server/report/render.h"

namespace rigcal::report {

// Every sensor in the order of the document: pose, how certain it is beside its limit, U, and the decision.
[[nodiscard]] CertificatePart PosesPart(const ReportInput& input);
// What its newest session found of the calibration in use, and what is off after the update, beside the limits.
[[nodiscard]] CertificatePart FoundPart(const ReportInput& input);
// Sessions that count, the newest in words and the others counted; boards; software; the document.
[[nodiscard]] CertificatePart MeasuredWithPart(const ReportInput& input, const std::string& cause);
// Whether the policy says of all that the pose leaves open that it is not needed.
[[nodiscard]] bool LacksOnlyNotNeeded(const SensorPose& pose, const formats::RevisionInput& revision);
// Sessions with an edge that counts, the newest first.
[[nodiscard]] std::vector<const SessionFacts*> SessionsThatCount(const ReportInput& input);

}  // namespace rigcal::report
