// What a session found of the calibration in use, as it is stored, told and read back (docs/api.md, as found).
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/formats/json/json_writer.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::formats {

// The document as it is stored, and back: bounded; the error names the wrong field.
[[nodiscard]] std::string WriteAsFound(const AsFound& found);
[[nodiscard]] Result<AsFound> ReadAsFound(std::string_view text);

// Members of an object, of the whole and at a glance.
void WriteAsFoundMembers(JsonWriter& out, const AsFound& found);
void WriteAsFoundMembers(JsonWriter& out, const AsFoundSummary& summary);

}  // namespace rigcal::formats
