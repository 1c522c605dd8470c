// Pairs that tell by themselves that one of their sensors was moved while captures were taken.
#include <gmock/gmock.h>

#include "tests/unit/fleet/causes/visit.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

void AddMoved(const std::string& a, const std::string& b, Visit& visit) {
  visit.AddFailed(a, b, "stereo", "moved_within",
                  {{"moved_after_idx", 1}, {"moved_from_idx", 2}, {"moved_m", 0.012}, {"moved_rad", 0.01745}});
  for (const char* name : {"01", "02", "03"})
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

TEST(MovedPairs, OfSeveralPairsTheSensorThatTheyShareWasMoved) {
  Visit visit(StereoBoard());
  for (const char* name : {"back", "left", "right"}) visit.AddSensor(name, SensorKind::kCamera);
  AddMoved("back", "left", visit);
  AddMoved("left", "right", visit);
  visit.AddGood("back", "right");
  EXPECT_THAT(OneCause(visit, CauseKind::kMovedWithin).sensors, ElementsAre(SensorId("left")));
}

}  // namespace
}  // namespace rigcal::fleet
