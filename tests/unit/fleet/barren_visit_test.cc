// The newest visit calibrated nothing: what older ones know stays in use, and somebody is told.
#include <gmock/gmock.h>

#include "server/fleet/findings/failures.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;

const SessionId kFirst(std::string(64, '1')), kSecond(std::string(64, '2'));
constexpr std::int64_t kDay_ns = 86'400'000'000'000;

// A triangle of the first visit, and two of its pairs again, which failed.
struct TwoVisits : Rig {
  SessionTimes captured_at = {{kFirst, Stamp{10 * kDay_ns}}, {kSecond, Stamp{20 * kDay_ns}}};
  TwoVisits() {
    for (Edge& edge : edges) edge.session = kFirst;
    edges.push_back(FailedEdge('d', "left", "right"));
    edges.push_back(FailedEdge('e', "right", "top"));
    edges[3].session = edges[4].session = kSecond;
  }
  [[nodiscard]] Verdict Judge() const { return Assess(edges, solution, {}, captured_at); }
};

TEST(BarrenVisit, AVisitOfWhichEachPairFailedIsNotMendedByOlderOnes) {
  const TwoVisits rig;
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn) << "the poses are known all the same";
  EXPECT_THAT(verdict.why, HasSubstr("left - right"));
  EXPECT_THAT(verdict.why, HasSubstr("right - top"));
  EXPECT_EQ(FindOpenFailures(rig.edges, rig.captured_at).size(), 2U);
}

TEST(BarrenVisit, OnePairThatIsGoodMakesItAVisit) {
  TwoVisits rig;
  rig.edges.push_back(MakeEdge('f', "left", "top"));
  rig.edges.back().session = kSecond;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass) << "of right there were too few captures";
}

// It may have been moved since: that it fitted before says nothing.
TEST(BarrenVisit, ASensorThatWasSeenAndFitsNothingAnyMoreIsTold) {
  TwoVisits rig;
  rig.edges.push_back(MakeEdge('f', "left", "top"));
  rig.edges.back().session = kSecond;
  for (Edge& edge : rig.edges)
    if (edge.state == EdgeState::kFailed) edge.diagnoses.front().code = "high_residual";
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn) << verdict.why;
  EXPECT_THAT(verdict.why, HasSubstr("left - right"));
  rig.edges[3].state = EdgeState::kGood;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass) << "right fits left";
}

TEST(BarrenVisit, AnotherVisitSinceMendsIt) {
  TwoVisits rig;
  rig.captured_at[kSecond] = Stamp{5 * kDay_ns};
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
}

}  // namespace
}  // namespace rigcal::fleet
