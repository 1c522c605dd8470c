// How sentences say that an edge can be taken out.
#pragma once

#include <string>

#include "server/model/edges/edge.h"

namespace rigcal::fleet {

// The command, or of a merged one that it stands for others, and how to see these.
[[nodiscard]] std::string RetireText(const Edge& edge);

}  // namespace rigcal::fleet
