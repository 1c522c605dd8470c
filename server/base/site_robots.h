// Servers of sites, which send on what robots pushed there: a token of theirs may do nothing else, not even read.
#pragma once

#include <string_view>

#include "server/base/result.h"

namespace rigcal {

inline constexpr std::string_view kSiteRole = "site";  // beside those of role.h, which have nothing in common with it

// Which robots a site sends on: names with commas between, each whole or the beginning of a name and a '*'.
// kInvalidInput names the one that is none.
[[nodiscard]] Status CheckRobotNames(std::string_view names);
// `names` as above; empty: none.
[[nodiscard]] bool IsAmongRobots(std::string_view names, std::string_view robot);

}  // namespace rigcal
