// Limits as an operator writes them: a YAML map `name: value`, or `name=value`. A value is a whole number; one of bytes
// may end in KiB, MiB or GiB. Errors name the limit, its range and, for an unknown name, the nearest one.
#pragma once

#include <string>
#include <string_view>

#include "server/base/limits_in_force.h"
#include "server/base/result.h"

namespace rigcal::formats {

// `limits` with what the YAML says; `name` starts every error. A file without any limit changes nothing.
[[nodiscard]] Result<limits::Limits> ReadLimits(std::string_view yaml, const std::string& name,
                                                const limits::Limits& limits = {});
// `limits` with one `name=value`.
[[nodiscard]] Result<limits::Limits> WithLimit(const limits::Limits& limits, std::string_view assignment);
// Each may be good, yet not beside the others: a file fits a session, a window fits the intake.
[[nodiscard]] Status CheckTogether(const limits::Limits& limits);
// "payload_bytes=1048576, open_sessions=4": those that differ from the defaults; empty if none does.
[[nodiscard]] std::string ChangedLimits(const limits::Limits& limits);

}  // namespace rigcal::formats
