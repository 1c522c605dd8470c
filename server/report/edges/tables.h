// The parts of a revision page: poses in the reference frame, edges, coloured clouds, provenance.
#pragma once

#include <vector>

#include "server/report/edges/cause_groups.h"
#include "server/report/edges/edge_order.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// A row per sensor up to a limit: its pose with sigmas, the part that was measured, or why it is not known.
void FillPoses(Dictionary& page, const formats::RevisionInput& revision);
// A row for those that one cause explains.
void FillEdges(Dictionary& page, const ReportInput& input, const EdgesByCause& edges);
void FillClouds(Dictionary& page, const CloudSection& section);
void FillProvenance(Dictionary& page, const ReportInput& input);

}  // namespace rigcal::report
