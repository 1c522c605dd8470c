// How a fused pose scatters from visit to visit, in the document of a revision (docs/api.md): keys of its `fused`.
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/graph/graph.h"

namespace rigcal::formats {

// `scatter`: where other robots told what theirs scatter by, so that the same can be made of it once more.
void WritePooledScatter(JsonWriter& out, const FusedPose& fused);
// `visit_scatter`: what was taken along each axis, where axes are unlike or no other robot told it.
void WriteScatterTaken(JsonWriter& out, const FusedPose& fused);
// Both, where they are there, into `fused`, which has its sessions. Of documents without either three numbers a visit
// stand behind the scatter, as these took axes as alike.
void ReadScatter(const JsonField& field, FusedPose& fused);

}  // namespace rigcal::formats
