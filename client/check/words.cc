#include "client/check/words.h"

#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/model/approval/policy.h"

namespace rigcal::check {

std::string Enumerated(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

std::string NamesText(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 6;
  if (names.size() <= kShown) return Enumerated(names);
  std::vector<std::string> shown(names.begin(), names.begin() + kShown);
  shown.push_back(std::to_string(names.size() - kShown) + " more");
  return Enumerated(shown);
}

std::string PairText(const SensorPair& pair) { return pair.a.str() + " - " + pair.b.str(); }

std::string DefaultLimitsText() {
  return client::Fixed(client::kMmPerM * kDefaultTolerance.m, 0) + " mm and " +
         client::Fixed(client::kDegPerRad * kDefaultTolerance.rad, 2) + " deg";
}

std::string SentenceOf(const Diagnosis& diagnosis) {
  return Sentence({ErrorCode::kInvalidInput, diagnosis.what, diagnosis.cure});
}

}  // namespace rigcal::check
