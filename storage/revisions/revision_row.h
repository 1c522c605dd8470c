// A row of the table revision, with what stands in the tables beside it. For storage/*.cc only.
#pragma once

#include "server/model/graph/graph.h"
#include "storage/database/query.h"

namespace rigcal::storage {

inline constexpr const char* kRevisionColumns =
    "revision.robot_id, revision.number, created_ns, revision.edge_watermark, verdict, verdict_why, "
    "verdict_what_to_do, revision.digest, "
    "(SELECT standing_watermark FROM revision_standing s WHERE s.robot_id = revision.robot_id AND "
    "s.revision_number = revision.number), "
    "(SELECT calibrated_ns FROM revision_calibrated c "
    "WHERE c.robot_id = revision.robot_id AND c.revision_number = revision.number), "
    "judged.policy_watermark, judged.max_age_ns, judged.unverified ";
inline constexpr const char* kRevisionJudged =
    "LEFT JOIN revision_judgement judged ON judged.robot_id = revision.robot_id AND judged.revision_number = "
    "revision.number ";

// The document, compressed, and as revisions of before have it: it stands in one of the two.
inline constexpr const char* kDocumentColumns =
    "(SELECT zstd FROM revision_document d WHERE d.robot_id = revision.robot_id AND d.revision_number = "
    "revision.number), document";

// Of a query whose first columns are these; without its document.
[[nodiscard]] Revision RevisionAt(const Query& query);
// Of a query with kDocumentColumns from `column` on. kStorage, which begins with `subject`: it is missing or damaged.
[[nodiscard]] Result<std::string> DocumentAt(const Query& query, int column, const std::string& subject);

}  // namespace rigcal::storage
