// The limits that people set, as they write them (docs/policy.md).
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/model/policy.h"

namespace rigcal::formats {

inline constexpr std::size_t kPolicyBytesMax = 32u << 10;

// `name` starts every error: "policy.yaml line 3: sensor 'left': unknown key "tolerance_m"; ...". A text that says
// nothing is a policy that says nothing.
[[nodiscard]] Result<Policy> ReadPolicy(std::string_view text, const std::string& name);

}  // namespace rigcal::formats
