// One page of a revision to print, sign and file: the verdict, every sensor's pose with what it is certain to beside
// the limits, and what it was measured with.
#pragma once

#include "server/report/render.h"

namespace rigcal::report {

inline constexpr const char* kCertificateFile = "certificate.html";  // beside the report's index.html

// The page. One side of A4 when printed: of more sensors, boards or sessions than there is room for it has the least
// certain, or the newest, and says how many more the report has.
[[nodiscard]] Result<std::string> RenderCertificate(const ReportInput& input);

}  // namespace rigcal::report
