// Which captures, in words.
#pragma once

#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal::check {

// In the order in which they were taken (calib/core/capture_blocks.h), each once.
[[nodiscard]] std::vector<CaptureId> InOrder(std::vector<CaptureId> captures);
// "03, 07 to 15 and 20": three or more that follow one another in `all` are one stretch; of very many stretches the
// first are told, and how many captures are left. `all` in order, with those of `some` in it.
[[nodiscard]] std::string Stretches(const std::vector<CaptureId>& some, const std::vector<CaptureId>& all);
// "files for 6 of 15 captures: 007 to 015 are missing"; empty where none is. `thing`: "files", "poses".
[[nodiscard]] std::string MissingText(const std::string& thing, const std::vector<CaptureId>& present,
                                      const std::vector<CaptureId>& all);

}  // namespace rigcal::check
