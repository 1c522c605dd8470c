// The hostile sessions, by name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/trust/trust_session.h"

namespace rigcal {

struct TrustScenario {
  std::string name;
  std::function<HostileVisit(int idx)> visit;  // idx counts from one; visits of one robot take several seeds
};

[[nodiscard]] const std::vector<TrustScenario>& TrustScenarios();

}  // namespace rigcal
