// Edges that were good and do not count any more.
#pragma once

#include <string_view>

#include "server/model/edge.h"

namespace rigcal {

// The code of a diagnosis: its session was pushed again in a corrected form, or a sensor was remounted since.
[[nodiscard]] bool MeansPast(std::string_view diagnosis_code);
[[nodiscard]] bool IsPast(const Edge& edge);

}  // namespace rigcal
