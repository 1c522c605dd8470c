// How robots are sorted by name and searched: text that is stored in their summaries. For storage/*.cc only.
#pragma once

#include <string>
#include <vector>

#include "server/model/robot_summary.h"

namespace rigcal::storage {

// Byte by byte it sorts ids as people count: "robot-9" before "robot-10".
[[nodiscard]] std::string NameKeyOf(const RobotId& robot);
// What a robot's row holds, in lower case.
[[nodiscard]] std::string SearchTextOf(const RobotSummary& summary);
// The words of a search, in lower case.
[[nodiscard]] std::vector<std::string> SearchWordsOf(const std::string& search);

}  // namespace rigcal::storage
