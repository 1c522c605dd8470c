// What the fleet is to be worked on by: counts of robots that open lists of them, by cause and by the week they are due
// in.
#pragma once

#include "server/model/robots/fleet_list.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// WORK, where there is any.
void FillWorkLists(Dictionary& page, const FleetCounts& fleet);

}  // namespace rigcal::report
