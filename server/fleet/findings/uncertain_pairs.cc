// Pairs of which a policy names a tolerance, and whose two sensors are known to each other to less.
#include <algorithm>

#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

struct UncertainPair {
  SensorPair pair;
  double sigma_m = 0.0, sigma_rad = 0.0;  // of the least certain axis
  PoseLimit wanted;
  [[nodiscard]] double Ratio() const { return std::max(sigma_m / wanted.m, sigma_rad / wanted.rad); }
};

UncertainPair HeldAgainst(const Policy& policy, const SensorPair& pair, const Matrix6d& covariance) {
  const Vector6d sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {pair, sigma.head<3>().maxCoeff(), sigma.tail<3>().maxCoeff(), LimitsOf(policy, pair.a, pair.b).tolerance};
}

// The least certain, by its own limit, first.
std::vector<UncertainPair> UncertainPairs(const Policy& policy, const PairCovariances& covariances) {
  std::vector<UncertainPair> uncertain;
  for (const auto& [pair, words] : policy.pairs) {
    const auto known = covariances.find(pair);
    if (known == covariances.end() || (!words.tolerance_m && !words.tolerance_rad)) continue;
    const UncertainPair one = HeldAgainst(policy, pair, known->second);
    if (one.Ratio() > 1.0) uncertain.push_back(one);
  }
  std::stable_sort(uncertain.begin(), uncertain.end(),
                   [](const UncertainPair& a, const UncertainPair& b) { return a.Ratio() > b.Ratio(); });
  return uncertain;
}

}  // namespace

std::optional<Finding> FindUncertainPairs(const Policy& policy, const PairCovariances& covariances) {
  const std::vector<UncertainPair> uncertain = UncertainPairs(policy, covariances);
  if (uncertain.empty()) return std::nullopt;
  std::vector<std::string> names;
  for (const UncertainPair& one : uncertain) names.push_back(one.pair.a.str() + " - " + one.pair.b.str());
  const UncertainPair& worst = uncertain.front();
  const std::string together =
      names.size() == 1 ? worst.pair.a.str() + " and " + worst.pair.b.str() : "the sensors of " + List(names);
  return Finding{List(names) + (names.size() == 1 ? " is known to " : " are known, at worst, to ") +
                     SigmaText(worst.sigma_m, worst.sigma_rad) + " only (" + LimitText(worst.wanted) + " wanted)",
                 "Capture " + together + " together at more distances and tilts",
                 {worst.pair.a, worst.pair.b},
                 SigmaFigure(names.front() + " known to", worst.sigma_m, worst.sigma_rad, worst.wanted)};
}

}  // namespace rigcal::fleet
