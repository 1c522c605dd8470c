// An edge as a revision of format 2 refers to it: what it is and says in one row. The edge itself has the rest.
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/edges/edge.h"

namespace rigcal::formats {

// The row, with those figures alone that say what kind of edge it is: merged or polished.
void WriteEdgeReference(JsonWriter& out, const Edge& edge);
// Not validated. Of the uncertainty rank, dof and source, and what SigmaOf tells: the variances in `covariance`, an
// axis without one in `unobservable_basis`. No information, contributions, captures, evidence.
[[nodiscard]] Edge ReadEdgeReference(const JsonField& field, const RobotId& robot);

}  // namespace rigcal::formats
