// Verdicts on cameras whose given intrinsics are not those of their lens, and on cameras that scatter as a whole.
#include <gmock/gmock.h>

#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;

SessionEstimate SessionWith(std::vector<ContradictedLens> lenses, char letter = '1') {
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, letter));
  for (const char* sensor : {"left", "right", "top"}) estimate.poses.push_back({SensorId(sensor), {}});
  estimate.contradicted_lenses = std::move(lenses);
  return estimate;
}

TEST(WrongIntrinsics, ExchangedOnesFailWithOneSentenceForBoth) {
  const Rig rig;
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {},
                                 {SessionWith({{SensorId("left"), 14.0, 0.0097, SensorId("right")},
                                               {SensorId("right"), 14.2, 0.0098, SensorId("left")}})});
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why,
            "The intrinsics of left and right are exchanged: what was given for each fits the lens of the other, and "
            "puts corners 14 px (0.56 deg) elsewhere.");
  EXPECT_EQ(verdict.what_to_do,
            "Exchange the intrinsics of left and right in session.yaml, then push again: `rigcal push FOLDER`.");
}

TEST(WrongIntrinsics, WithinTheToleranceOfAnglesTheyWarn) {
  const Rig rig;
  const Verdict verdict =
      Assess(rig.edges, rig.solution, {}, {}, {SessionWith({{SensorId("left"), 1.4, 0.001, SensorId("top")}})});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("intrinsics given for left do not fit its lens: they put corners 1.4 px (0.057 "
                                     "deg) elsewhere; what was given for top fits it"));
}

TEST(WrongIntrinsics, ThoseOfAnOlderSessionAreMended) {
  const Rig rig;
  const SessionEstimate old = SessionWith({{SensorId("left"), 14.0, 0.0097, {}}});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {SessionWith({}, '2'), old}).level, VerdictLevel::kPass);
}

// Pairs take intrinsics as given: what they contradict is known to be wrong, also after better ones were pushed.
TEST(WrongIntrinsics, TheirPairsAccuseNobody) {
  Rig rig;
  for (Edge& edge : rig.edges) edge.session = SessionId(std::string(64, '1'));
  rig.solution.residuals[0] = ResidualOf(rig.edges[0], 0.06);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  ASSERT_EQ(Assess(rig.edges, rig.solution, {}, {}, {SessionWith({}, '2')}).level, VerdictLevel::kFail);
  const SessionEstimate old = SessionWith({{rig.edges[0].frame_a, 14.0, 0.0097, {}}});
  EXPECT_NE(Assess(rig.edges, rig.solution, {}, {}, {SessionWith({}, '2'), old}).level, VerdictLevel::kFail);
}

TEST(LookScatter, IsARemarkThatNamesTheWorst) {
  const Rig rig;
  SessionEstimate estimate = SessionWith({});
  estimate.look_scatter = {{SensorId("left"), 7.5e-5}, {SensorId("right"), 1e-4}};
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {estimate});
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_THAT(verdict.why, HasSubstr("ictures of right and of 1 other camera are off as a whole from capture to "
                                     "capture, by 0.0057 deg at worst"));
}

}  // namespace
}  // namespace rigcal::fleet
