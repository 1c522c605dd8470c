#include "client/check/advice.h"

#include <algorithm>

#include "client/check/words.h"
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

std::vector<SensorId> LidarsOnlyCounted(const Findings& findings) {
  std::vector<SensorId> lidars;
  for (const LidarFound& lidar : findings.lidars)
    if (IsInPair(findings, lidar.lidar)) lidars.push_back(lidar.lidar);
  return lidars;
}

}  // namespace

Judgement JudgeFindings(const Findings& findings) {
  Judgement judgement;
  std::vector<Advice> all = SensorAdvice(findings);
  const std::vector<Advice> of_pairs = PairAdvice(findings, all);
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
  for (std::string& remark : PairRemarks(findings)) judgement.remarks.push_back(std::move(remark));
  judgement.clouds_of = LidarsOnlyCounted(findings);
  return judgement;
}

std::string Headline(const Judgement& judgement) {
  if (judgement.IsEnough() && judgement.clouds_of.empty()) return "Enough.";
  if (judgement.IsEnough()) {
    std::vector<std::string> lidars;
    for (const SensorId& lidar : judgement.clouds_of) lidars.push_back(lidar.str());
    return "Enough, as far as was looked: whether the clouds of " + NamesText(lidars) +
           " show the board is found after the push.";
  }
  if (judgement.captures_more == 0) return "Not enough yet.";
  const bool alone = judgement.advice.size() == 1;
  return std::string("Take ") + (alone ? "" : "at least ") + calib::CountText(judgement.captures_more, "more capture") +
         ".";
}

}  // namespace rigcal::check
