// A manifest's members, for documents that hold one.
#pragma once

#include "server/formats/json/json_writer.h"
#include "server/model/sessions/session.h"

namespace rigcal::formats {

// Members of an object that is open: the header's, then "payloads" in their order.
void WriteManifestMembers(JsonWriter& out, const Manifest& manifest);

}  // namespace rigcal::formats
