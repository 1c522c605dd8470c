// How many days before the newest visit the others were made, as far as a walk goes on.
#pragma once

#include "server/graph/fusion/session_fusion.h"

namespace rigcal::graph {

// Between two visits a sensor walks for so many days at most: a robot that is parked does not go astray, and one wrong
// date makes all the others' days none.
constexpr double kWalkedDaysMax = 90.0;

// Into the factors, which are the newest first. A session without a date is of that of the one before it in the list,
// an edge without one, or with one after the newest session's, of the newest session.
void TakeAges(const VisitDates& dates, SessionFusion& fusion);
// What the next visit is told for: the longer of the days between the newest two sessions of different dates and of the
// mean between all.
[[nodiscard]] double DaysUntilNext(const SessionFusion& fusion);

}  // namespace rigcal::graph
