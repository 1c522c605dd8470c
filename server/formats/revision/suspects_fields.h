// The suspects of a revision in JSON (docs/api.md, revision).
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/graph/suspects.h"

namespace rigcal::formats {

// {"judged", "edges": [...], "two_poses": [...]}.
void WriteSuspects(JsonWriter& out, std::string_view key, const Suspects& suspects);
[[nodiscard]] Suspects ReadSuspects(const JsonField& field);

}  // namespace rigcal::formats
