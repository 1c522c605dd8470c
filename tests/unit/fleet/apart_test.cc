// Sensors that sat elsewhere on another visit, which a loose mount may explain: never a pass without a word.
#include <gmock/gmock.h>

#include "server/fleet/findings/verdict_keys.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const SessionId kOld(std::string(64, '1')), kNew(std::string(64, '2'));
const SessionTimes kTimes = {{kOld, Stamp{0}}, {kNew, Stamp{86'400'000'000'000}}};

struct Visited : Rig {
  explicit Visited(int visits = 2) {
    solution.fused.sessions = {kNew, kOld};
    for (SensorPose& pose : solution.poses) pose.fused.emplace().sessions = visits;
  }
  void Add(const char* sensor, double off_m) {
    SensorMovedBetween one{SensorId(sensor), kOld, kNew, Vector6d::Zero(), 1e-9};
    one.step[tangent::kX] = off_m;
    solution.fused.apart.push_back(one);
  }
  [[nodiscard]] Verdict Told(const Policy& policy = {}) const { return Assess(edges, solution, policy, kTimes); }
};

TEST(AssessApart, BeyondTheToleranceWarnsWithBothWaysOut) {
  Visited rig;
  rig.Add("right", 0.006);
  const Verdict verdict = rig.Told();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why,
            "right sat 6 mm elsewhere in the session of 1970-01-01 than in that of 1970-01-02 (limit 5 mm): it was "
            "moved, or its mount is loose; two visits cannot tell which.");
  EXPECT_EQ(verdict.what_to_do,
            "Was right moved after 1970-01-01? Yes: `rigcal push FOLDER --remounted right` of the session of "
            "1970-01-02. No: check its mount. Loose: tighten it, capture again, then `rigcal push FOLDER --remounted "
            "right`. Firm: push another session.");
  EXPECT_THAT(KeysOfVerdict(verdict, rig.edges, rig.solution, {}, {}, {}), ElementsAre("apart right"));
}

TEST(AssessApart, EverySensorIsNamedOnceTheWorstFirst) {
  Visited rig;
  rig.Add("top", 0.006);
  rig.Add("right", 0.007);
  rig.Add("right", 0.009);
  const Verdict verdict = rig.Told();
  EXPECT_THAT(verdict.why, StartsWith("right sat 9 mm elsewhere"));
  EXPECT_THAT(verdict.why, HasSubstr("; top sat 6 mm elsewhere"));
  EXPECT_THAT(verdict.why, Not(HasSubstr("7 mm")));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("--remounted right,top`"));
}

TEST(AssessApart, WithinTheToleranceIsToldBesideThePass) {
  Visited rig;
  rig.Add("right", 0.004);
  const Verdict verdict = rig.Told();
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_EQ(verdict.why,
            "right sat 4 mm elsewhere in the session of 1970-01-01 than in that of 1970-01-02 (limit 5 mm), more than "
            "the sessions err by: two visits do not tell whether it was moved or its mount gives. Every sensor is "
            "known well enough.");
  Policy narrow;
  narrow.all.tolerance_m = 0.003;
  EXPECT_EQ(rig.Told(narrow).level, VerdictLevel::kWarn) << "the policy's own tolerance";
}

// No larger than the policy's least move, or of a sensor whose scatter is known and told with its pose.
TEST(AssessApart, WhatMattersToNobodyIsNotTold) {
  Visited small, many(3);
  small.Add("right", 0.0009);
  many.Add("right", 0.004);
  for (const Visited& rig : {small, many}) {
    EXPECT_EQ(rig.Told().level, VerdictLevel::kPass);
    EXPECT_THAT(rig.Told().why, Not(HasSubstr("elsewhere")));
  }
  many.Add("right", 0.006);
  EXPECT_EQ(many.Told().level, VerdictLevel::kWarn) << "no sound mount gives by so much";
}

// Pairs of refined sessions that differ by 12 mm accuse nobody; that they agree is not said all the same.
TEST(AssessApart, PairsThatDifferAreNotSaidToAgree) {
  Visited rig;
  for (Edge& edge : rig.edges) edge.session = kNew;
  EXPECT_THAT(rig.Told().why, HasSubstr("the edges agree with each other"));
  rig.solution.residuals[0] = ResidualOf(rig.edges[0], 0.012);
  const Verdict verdict = rig.Told();
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_THAT(verdict.why, Not(HasSubstr("agree with each other")));
  EXPECT_THAT(verdict.why, StartsWith("Every sensor is known well enough. ")) << "what enters no pose comes last";
  EXPECT_THAT(verdict.why, HasSubstr(" Taken pair by pair, left and right differ by 12 mm"));
}

}  // namespace
}  // namespace rigcal::fleet
