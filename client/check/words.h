// Words that several sentences share.
#pragma once

#include <string>
#include <vector>

#include "server/model/diagnosis.h"
#include "server/model/sessions/session.h"

namespace rigcal::check {

// "left", "left and up", "left, right and up".
[[nodiscard]] std::string Enumerated(const std::vector<std::string>& words);
// The same of names, the first six of them: "a, b, c, d, e, f and 3 more".
[[nodiscard]] std::string NamesText(const std::vector<std::string>& names);

// "left - right"
[[nodiscard]] std::string PairText(const SensorPair& pair);
// "5 mm and 0.29 deg": by which it judges, as no server is asked for its policy.
[[nodiscard]] std::string DefaultLimitsText();
// What, and what to do.
[[nodiscard]] std::string SentenceOf(const Diagnosis& diagnosis);

}  // namespace rigcal::check
