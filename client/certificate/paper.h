// A certificate on pages of A4.
#pragma once

#include <vector>

#include "client/print/sheet.h"
#include "server/model/certificate.h"

namespace rigcal::client {

// From the top, type of one size for each kind of line; tables that are wider than a page have smaller type. What has
// no room on a page goes on, on the next: rows whole, below the heading and the titles of their table once more. Each
// page says at its foot which it is, of how many.
[[nodiscard]] std::vector<print::Sheet> OnPaper(const Certificate& certificate);

}  // namespace rigcal::client
