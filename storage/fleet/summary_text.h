// How robots are sorted by name and searched: text that is stored in their summaries. For storage/*.cc only.
#pragma once

#include <string>
#include <vector>

#include "server/model/robots/robot_summary.h"

namespace rigcal::storage {

// Byte by byte it sorts ids as people count: "robot-9" before "robot-10".
[[nodiscard]] std::string NameKeyOf(const RobotId& robot);
// What a robot's row holds, in lower case, but for what changes with the time.
[[nodiscard]] std::string SearchTextOf(const RobotSummary& summary);
// The words of a search, in lower case.
[[nodiscard]] std::vector<std::string> SearchWordsOf(const std::string& search);

// Keys of causes, which hold no character that JSON escapes, as json_each takes them; and back.
[[nodiscard]] std::string ListOfKeys(const std::vector<std::string>& keys);
[[nodiscard]] std::vector<std::string> KeysOfList(const std::string& list);

}  // namespace rigcal::storage
