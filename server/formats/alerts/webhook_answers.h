// The documents of verbs webhooks and due_ics (docs/api.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/model/robots/alert.h"

namespace rigcal::formats {

// verb webhooks: {"webhooks": [...]}.
[[nodiscard]] std::string WriteWebhooks(const std::vector<ReceiverState>& receivers, Stamp now);
// verb due_ics: {"ics": the calendar, "without_date": robots that were never calibrated}.
[[nodiscard]] std::string WriteDueCalendar(std::string_view calendar, std::int64_t without_date);

}  // namespace rigcal::formats
