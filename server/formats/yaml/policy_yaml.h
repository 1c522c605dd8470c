// The limits that people set, as they write them (docs/policy.md).
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/model/approval/policy.h"

namespace rigcal::formats {

inline constexpr std::size_t kPolicyBytesMax = 32u << 10;

// `name` starts every error: "policy.yaml line 3: sensor 'left': unknown key "tolerance_m"; ...". A text that says
// nothing is a policy that says nothing. A limit below the least of its unit (0.001 mm, 0.0001 deg, 0.001 px, 1 h) is
// refused: by it nothing could be judged.
[[nodiscard]] Result<Policy> ReadPolicy(std::string_view text, const std::string& name);
// Of a text that somebody set before: what is above 0 and below the least counts as the least, so that robots are
// judged all the same.
[[nodiscard]] Result<Policy> ReadStoredPolicy(std::string_view text, const std::string& name);

}  // namespace rigcal::formats
