// What a verdict rests on, in JSON (docs/api.md): of a revision's document, and of the status that a revision keeps.
#pragma once

#include <string_view>

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/verdict_basis.h"

namespace rigcal::formats {

// "verdict_basis": {"culprits", "decided_by": {"limit", "name", "value"}, "doubted", "hardly_checked": [{"edge",
// "what"}], "reasons": [{"what_to_do", "why"}]}, each only where it says something; nothing where none does.
void WriteVerdictBasis(JsonWriter& out, const VerdictBasis& basis);
// Empty in what is from before it was kept.
[[nodiscard]] VerdictBasis ReadVerdictBasis(const JsonField& root);

}  // namespace rigcal::formats
