// A row of the table revision, with what stands in the tables beside it. For storage/*.cc only.
#pragma once

#include "server/model/graph/graph.h"
#include "storage/database/query.h"

namespace rigcal::storage {

inline constexpr const char* kRevisionColumns =
    "revision.robot_id, revision.number, created_ns, revision.edge_watermark, verdict, verdict_why, "
    "verdict_what_to_do, digest, "
    "(SELECT standing_watermark FROM revision_standing s WHERE s.robot_id = revision.robot_id AND "
    "s.revision_number = revision.number), "
    "(SELECT calibrated_ns FROM revision_calibrated c "
    "WHERE c.robot_id = revision.robot_id AND c.revision_number = revision.number), "
    "judged.policy_watermark, judged.max_age_ns, judged.unverified ";
inline constexpr const char* kRevisionJudged =
    "LEFT JOIN revision_judgement judged ON judged.robot_id = revision.robot_id AND judged.revision_number = "
    "revision.number ";

// Of a query whose first columns are these; without its document.
[[nodiscard]] Revision RevisionAt(const Query& query);

}  // namespace rigcal::storage
