#include "client/check/advice.h"

#include <algorithm>

#include "server/calib/core/wording.h"

namespace rigcal::check {
namespace {

// What is said alike of several is said once.
std::vector<Advice> Grouped(const std::vector<Advice>& all) {
  std::vector<Advice> groups;
  for (const Advice& one : all) {
    const auto known = std::find_if(groups.begin(), groups.end(), [&](const Advice& group) {
      return group.text == one.text && group.urgency == one.urgency && group.captures_more == one.captures_more;
    });
    if (known == groups.end())
      groups.push_back(one);
    else
      known->of.insert(known->of.end(), one.of.begin(), one.of.end());
  }
  return groups;
}

bool IsWorse(const Advice& x, const Advice& y) {
  if (x.urgency != y.urgency) return x.urgency > y.urgency;
  return x.captures_more > y.captures_more;
}

// Blurred pictures and open sides do not keep a pair from being judged by itself.
std::set<SensorId> Explained(const std::vector<Advice>& of_sensors) {
  std::set<SensorId> explained;
  for (const Advice& advice : of_sensors)
    if (advice.urgency != Urgency::kRough)
      for (const std::string& name : advice.of) explained.insert(SensorId(name));
  return explained;
}

}  // namespace

Judgement JudgeFindings(const Findings& findings) {
  Judgement judgement;
  std::vector<Advice> all = SensorAdvice(findings);
  const std::vector<Advice> of_pairs = PairAdvice(findings, Explained(all));
  all.insert(all.end(), of_pairs.begin(), of_pairs.end());
  if (findings.pairs.empty())
    all.push_back({{findings.robot.str()},
                   "no two of its sensors can be calibrated with each other: docs/session-format.md, \"Which pairs are "
                   "calibrated\", says what it takes",
                   Urgency::kNoAnswer,
                   0});
  judgement.advice = Grouped(all);
  std::stable_sort(judgement.advice.begin(), judgement.advice.end(), IsWorse);
  for (const Advice& advice : judgement.advice)
    judgement.captures_more = std::max(judgement.captures_more, advice.captures_more);
  judgement.remarks = RemarksOf(findings);
  return judgement;
}

std::string Headline(const Judgement& judgement) {
  if (judgement.IsEnough()) return "Enough.";
  if (judgement.captures_more == 0) return "Not enough yet.";
  const bool alone = judgement.advice.size() == 1;
  return std::string("Take ") + (alone ? "" : "at least ") + calib::CountText(judgement.captures_more, "more capture") +
         ".";
}

}  // namespace rigcal::check
