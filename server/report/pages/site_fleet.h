// The fleet index of the server of a site.
#pragma once

#include "server/model/robots/forward_state.h"
#include "server/report/render.h"

namespace rigcal::report {

// RenderFleet (render.h) with a line on what is not at the centre yet, and why; without one where nothing waits.
[[nodiscard]] Result<std::string> RenderSiteFleet(const FleetCounts& fleet, const FleetPage& list, Stamp now,
                                                  const FleetQuery& query, std::size_t experiments, std::size_t boards,
                                                  const ForwardState& forward);

}  // namespace rigcal::report
