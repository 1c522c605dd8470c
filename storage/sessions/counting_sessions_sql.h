// Which sessions count, as SQL. For storage/*.cc only.
#pragma once

#include <string>

namespace rigcal::storage {

// Of a row `session`: that it is neither superseded (LoadSuperseded) nor retired (LoadRetiredSessions).
[[nodiscard]] const std::string& SessionCounts();

}  // namespace rigcal::storage
