// The coloured verdict at the head of a page.
#pragma once

#include "server/model/diagnosis.h"
#include "server/report/page.h"

namespace rigcal::report {

void FillBanner(Dictionary& page, const Verdict& verdict);
// LEVEL (class) and WORD of a small verdict badge.
void FillBadge(Dictionary& row, VerdictLevel level);

}  // namespace rigcal::report
