// A judged session as JSON: what was done, what is said, how far off it is.
#pragma once

#include "server/formats/json/json_writer.h"
#include "tests/bench/trust/trust_session.h"

namespace rigcal {

// Lengths in metres, angles in radians.
void WriteJudged(const JudgedVisit& judged, formats::JsonWriter& out);

}  // namespace rigcal
