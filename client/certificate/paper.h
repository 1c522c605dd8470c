// A certificate's lines on one page of A4.
#pragma once

#include "client/certificate/lines.h"
#include "client/print/sheet.h"

namespace rigcal::client {

// From the top, type of one size for each style; tables that are wider than the page have smaller type. kInvalidInput
// where the lines are more than a page takes.
[[nodiscard]] Result<print::Sheet> OnPaper(const std::vector<CertificateLine>& lines);

}  // namespace rigcal::client
