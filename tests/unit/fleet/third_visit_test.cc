// A robot one of whose sensors was moved after its first visit and stays there, judged as its visits come.
#include <gmock/gmock.h>

#include "server/fleet/assess.h"
#include "tests/unit/graph/fusion/drawn_visits.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;

// Loose by what a sound mount is from visit to visit.
Verdict AfterVisits(int visits, double moved_m, int first_after) {
  graph::Random random(5);
  graph::Robot robot;
  for (int k = 0; k < visits; ++k) {
    std::vector<Se3> places = graph::Truth();
    if (k >= first_after) places[2] = places[2] * Se3::Exp(moved_m * Vector6d::Unit(tangent::kY));
    robot.Add(graph::Drawn(k, graph::Scattered(places, 2e-4, 1e-4, random), graph::CovarianceOf(1e-4, 1e-4), random));
  }
  std::reverse(robot.estimates.begin(), robot.estimates.end());  // the newest first
  return Assess(robot.edges, robot.Fused(), {}, {}, robot.estimates);
}

TEST(ThirdVisit, DoesNotTakeBackThatASensorWasMoved) {
  for (const int visits : {2, 3, 4, 5}) {
    const Verdict verdict = AfterVisits(visits, 0.008, 1);
    EXPECT_EQ(verdict.level, VerdictLevel::kFail) << visits << " visits: " << verdict.why;
    EXPECT_THAT(verdict.why, HasSubstr("right was moved between the sessions of"));
    EXPECT_THAT(verdict.what_to_do, HasSubstr("--remounted right`"));
    EXPECT_THAT(verdict.what_to_do, HasSubstr(visits == 2 ? "No: tighten the mount" : "take it out: `rigcal retire "));
  }
}

TEST(ThirdVisit, MayTellTheMoveItself) { EXPECT_EQ(AfterVisits(3, 0.008, 2).level, VerdictLevel::kFail); }

TEST(ThirdVisit, AccusesNobodyWhereNothingMoved) { EXPECT_NE(AfterVisits(3, 0.0, 1).level, VerdictLevel::kFail); }

}  // namespace
}  // namespace rigcal::fleet
