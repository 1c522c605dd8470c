// What a revision rests on, in JSON (docs/api.md, show): influence of edges and cycles.
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/graph/insight.h"

namespace rigcal::formats {

// Of one edge, as member "influence": null where the edge has none.
void WriteInfluence(JsonWriter& out, const Influences& influences, const EdgeId& edge);
[[nodiscard]] EdgeInfluence ReadInfluence(const JsonField& field, const EdgeId& edge);
// Of the whole: {"judged", "why_not"}.
void WriteInfluenceState(JsonWriter& out, std::string_view key, const Influences& influences);
[[nodiscard]] Influences ReadInfluenceState(const JsonField& field);

// {"judged", "why_not", "examined", "tested", "failing", "worst": [...]}.
void WriteCycles(JsonWriter& out, std::string_view key, const Cycles& cycles);
[[nodiscard]] Cycles ReadCycles(const JsonField& field);

}  // namespace rigcal::formats
