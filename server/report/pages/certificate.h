// The certificate of a revision as a page to print, sign and file.
#pragma once

#include "server/report/certificate/content.h"

namespace rigcal::report {

inline constexpr const char* kCertificateFile = "certificate.html";  // beside the report's index.html

// `root`: the relative path to the folder with style.css and assets/, "" beside the report.
[[nodiscard]] Result<std::string> RenderCertificate(const ReportInput& input, const CertificateStanding& standing,
                                                    const std::string& root);

}  // namespace rigcal::report
