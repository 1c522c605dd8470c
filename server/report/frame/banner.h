// The coloured verdict at the head of a page.
#pragma once

#include <optional>

#include "server/model/approval/validity.h"
#include "server/model/robots/robot_runs.h"
#include "server/model/verdict_basis.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// The drive rule first; with that it is overdue, and what to use where it failed. A page that is made once knows no
// now: it carries the words for later, and a script shows them when their time has come (web-static/overdue.js).
// `has_revision`: false for a robot of which there is nothing yet. `runs`: of a page that tells of the robot now.
// Of several reasons the first is told, and the others in a fold.
void FillBanner(Dictionary& page, const Verdict& verdict, const Validity& validity, bool has_revision = true,
                const std::optional<Runs>& runs = {}, const VerdictBasis& basis = {});
// OVERDUE, or LATER with UNTIL: what is said once it is overdue, TEXT, and the BADGE and LATE_WORD for it; OVERDUE also
// of what has no date.
void FillOverdue(Dictionary& row, const Verdict& verdict, const Validity& validity,
                 const std::optional<Runs>& runs = {});
// DRIVE, with ENDS where time ends it; not of what OVERDUE tells.
void FillDrive(Dictionary& row, const Verdict& verdict, const Validity& validity, const std::optional<Runs>& runs = {});
// LEVEL (class) and WORD of a small verdict badge.
void FillBadge(Dictionary& row, VerdictLevel level);

}  // namespace rigcal::report
