// The choice of a stream's moments as JSON, and back.
#pragma once

#include "client/import/still_moments.h"
#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::importing {

// Members "moments" and "clocks" of an outcome.
void WriteMoments(formats::JsonWriter& out, const MomentsTold& told);
// What that wrote, of an outcome that has it.
[[nodiscard]] MomentsTold MomentsAt(const formats::JsonField& outcome);

}  // namespace rigcal::importing
