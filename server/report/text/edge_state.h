// What an edge is worth, in a word and a colour.
#pragma once

#include "server/model/edges/edge.h"

namespace rigcal::report {

[[nodiscard]] const char* StateWord(const Edge& edge);  // "good"; "failed"; "past": it was good, and does not count now
[[nodiscard]] const char* StateLevel(const Edge& edge);  // of its badge
// Failed by itself: something is to be done about it.
[[nodiscard]] bool HasFailed(const Edge& edge);

}  // namespace rigcal::report
