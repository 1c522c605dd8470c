#include "server/base/site_robots.h"

#include <string>

#include "server/base/ids.h"
#include "server/base/text.h"

namespace rigcal {
namespace {

// The next of `names`, which loses it.
std::string_view NextName(std::string_view& names) {
  const std::size_t comma = names.find(',');
  const std::string_view name = names.substr(0, comma);
  names = comma == std::string_view::npos ? std::string_view() : names.substr(comma + 1);
  return name;
}

}  // namespace

Status CheckRobotNames(std::string_view names) {
  do {
    const std::string_view name = NextName(names);
    const bool is_good = name == "*" || CheckName("robot", name.substr(0, name.size() - (name.ends_with('*') ? 1 : 0)));
    if (!is_good)
      return Fail(ErrorCode::kInvalidInput, Quoted(name) + " names no robots",
                  "Write names with commas between, each whole or with a * at its end: mapper-*,bench-1.");
  } while (!names.empty());
  return {};
}

bool IsAmongRobots(std::string_view names, std::string_view robot) {
  while (!names.empty()) {
    const std::string_view name = NextName(names);
    const bool begins = name.ends_with('*');
    if (begins ? robot.starts_with(name.substr(0, name.size() - 1)) : robot == name) return true;
  }
  return false;
}

}  // namespace rigcal
