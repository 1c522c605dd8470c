#pragma once

#include <string_view>

namespace rigcal {
// "0.2.0", from the project() line of CMake.
[[nodiscard]] std::string_view Version();
constexpr int kWireProtocol = 1;
}  // namespace rigcal
