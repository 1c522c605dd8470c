// Pairs that tell by themselves that one of their sensors was moved while captures were taken.
#include <gmock/gmock.h>

#include "tests/unit/fleet/causes/visit.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

void AddMoved(const std::string& a, const std::string& b, Visit& visit, int after = 1, int from = 2) {
  visit.AddFailed(a, b, "stereo", "moved_within",
                  {{"moved_after_idx", after}, {"moved_from_idx", from}, {"moved_m", 0.012}, {"moved_rad", 0.01745}});
  for (const char* name : {"01", "02", "03", "04"})
    visit.edges.back().captures.push_back({CaptureId(name), 0.0, false, "the pair was not solved"});
}

TEST(MovedPairs, OfTwoSensorsEitherMayHaveBeenMoved) {
  Visit visit(StereoBoard());
  for (const char* name : {"left", "right"}) visit.AddSensor(name, SensorKind::kCamera);
  AddMoved("left", "right", visit);
  const RootCause cause = OneCause(visit, CauseKind::kMovedWithin);
  EXPECT_THAT(cause.sensors, ElementsAre(SensorId("left"), SensorId("right")));
  EXPECT_THAT(cause.captures, ElementsAre(CaptureId("02"), CaptureId("03")));
  const Verdict verdict = visit.Judge(SolutionOf({"left"}, {"right"}));
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("left or right was moved during the session of "));
  EXPECT_THAT(verdict.why, HasSubstr("between captures 02 and 03, by 12 mm and 1 deg, or a lens changed"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("rigcal push FOLDER --remounted left,right"));
}

// What a pair failed for in an older visit, and nobody captured again, is no reason not to drive on the newer one.
TEST(MovedPairs, OfAnOlderVisitFailNothing) {
  Visit visit(StereoBoard());
  for (const char* name : {"left", "right"}) visit.AddSensor(name, SensorKind::kCamera);
  AddMoved("left", "right", visit);
  const std::vector<RootCause> causes = visit.Causes();
  EXPECT_TRUE(IsOfNewestVisit(causes.front(), visit.edges, visit.Times()));
  std::vector<Edge> edges = visit.edges;
  edges.push_back(edges.front());
  edges.back().id = EdgeId(std::string(64, 'f'));
  edges.back().session = SessionId(std::string(64, '2'));
  SessionTimes times = visit.Times();
  times[edges.back().session] = Stamp{times.begin()->second.ns + 1};
  EXPECT_FALSE(IsOfNewestVisit(causes.front(), edges, times));
  edges.back().state = EdgeState::kFailed;
  edges.back().diagnoses = {{"retired", "Set aside.", "Restore it."}};
  EXPECT_TRUE(IsOfNewestVisit(causes.front(), edges, times)) << "what was set aside is no visit";
}

TEST(MovedPairs, WithoutTheirCapturesNameNone) {
  Visit visit(StereoBoard());
  for (const char* name : {"left", "right"}) visit.AddSensor(name, SensorKind::kCamera);
  visit.AddFailed("left", "right", "stereo", "moved_within", {{"moved_m", 0.012}, {"moved_rad", 0.01745}});
  const RootCause cause = OneCause(visit, CauseKind::kMovedWithin);
  EXPECT_TRUE(cause.captures.empty());
  EXPECT_THAT(cause.said.why, Not(HasSubstr("between captures")));
}

TEST(MovedPairs, OfSeveralPairsTheSensorThatTheyShareWasMoved) {
  Visit visit(StereoBoard());
  for (const char* name : {"back", "left", "right"}) visit.AddSensor(name, SensorKind::kCamera);
  AddMoved("back", "left", visit, 0, 2);   // saw nothing in 02
  AddMoved("left", "right", visit, 1, 3);  // nor in 03
  visit.AddGood("back", "right");
  const RootCause cause = OneCause(visit, CauseKind::kMovedWithin);
  EXPECT_THAT(cause.sensors, ElementsAre(SensorId("left")));
  EXPECT_THAT(cause.captures, ElementsAre(CaptureId("02"), CaptureId("03")));
}

}  // namespace
}  // namespace rigcal::fleet
