// The causes of a revision in JSON (docs/api.md, causes).
#pragma once

#include <vector>

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/cause.h"

namespace rigcal::formats {

// Nothing where there are none.
void WriteCauses(JsonWriter& out, const std::vector<Cause>& causes);
// Of the revision's document; of one from before causes were kept there are none.
[[nodiscard]] std::vector<Cause> ReadCauses(const JsonField& root);

}  // namespace rigcal::formats
