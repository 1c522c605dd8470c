// READ: edges of earlier visits whose pictures and captures stay on the reports of those visits.
#pragma once

#include "server/report/render.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// For ReportInput::detailed_in. `input` as it is without. A report has the details of what is new in it, of its newest
// session, of pushed edges, of those that speak for a camera, and of what is worth looking at again
// (report::WorthDetails): so it costs the same however many visits the robot's window holds. `watermark`: of the
// revision.
[[nodiscard]] Result<std::map<EdgeId, int>> LoadDetailedEarlier(storage::Store& store, const report::ReportInput& input,
                                                                std::int64_t watermark);

}  // namespace rigcal::pipeline
