// Whom the first sentence of a verdict is about.
#pragma once

#include <optional>

#include "server/formats/documents.h"

namespace rigcal::report {

// The sensor that the verdict's sentence names first; nothing where it passes, or names none. That one is selected in
// 3D and marked in the table of sensors, so that a page is about one thing.
[[nodiscard]] std::optional<SensorId> CulpritOf(const formats::RevisionInput& revision);

}  // namespace rigcal::report
