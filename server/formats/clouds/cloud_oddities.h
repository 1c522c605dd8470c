// What is odd about the places of a cloud's points, and what that means.
#pragma once

#include <string>

#include "server/base/result.h"
#include "server/model/sensors/cloud.h"

namespace rigcal::formats {

// Points beyond 1 km; half of them or more without finite coordinates or at 0, 0, 0; nine tenths in a ball of 1 mm.
// A sentence with the counts and what to look for; empty if there is nothing. Beams without a return are not odd as
// such.
[[nodiscard]] std::string OdditiesOf(const Cloud& cloud);
// Refuses what holds no scene: nearly all that is left lies in a ball of 1 mm. The error names the file.
[[nodiscard]] Status CheckUseful(const Cloud& cloud, const std::string& name);

}  // namespace rigcal::formats
