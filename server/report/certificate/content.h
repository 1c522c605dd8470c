// What the certificate of a revision says, for the page and for the PDF alike.
#pragma once

#include "server/model/approval/decision.h"
#include "server/model/certificate.h"
#include "server/model/robots/robot_runs.h"
#include "server/report/render.h"

namespace rigcal::report {

// How a revision stands when its certificate is made.
struct CertificateStanding {
  Validity validity;
  std::optional<Approval> approval =
      {};  // absent: not known, as in a report, which looks the same whenever it is drawn
  std::optional<Runs> runs = {};
};
// As the report's own copy has it: as of when the report was drawn, so that it is never overdue.
[[nodiscard]] CertificateStanding StandingWhenDrawn(const ReportInput& input);

// Of `input` its revision (which need not be whole), number, times, digest, software, sessions and what was found.
[[nodiscard]] Certificate CertificateOf(const ReportInput& input, const CertificateStanding& standing);

}  // namespace rigcal::report
