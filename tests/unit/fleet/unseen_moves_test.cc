// What moves during a session, and what a bump would have shown, is told.
#include <gmock/gmock.h>

#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;

SessionEstimate SessionOfMoves(std::vector<std::pair<const char*, SmallestMove>> moves) {
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, '1'));
  for (const auto& [sensor, move] : moves) estimate.poses.push_back({SensorId(sensor), {}, 0.0, move});
  return estimate;
}

Verdict VerdictOfMoves(std::vector<std::pair<const char*, SmallestMove>> moves) {
  const Rig rig;
  return Assess(rig.edges, rig.solution, {},
                {{SessionId(std::string(64, '1')), ParseIso("2026-01-31T12:00:00Z").value()}},
                {SessionOfMoves(std::move(moves))});
}

TEST(AssessUnseen, APassSaysWhatWouldHaveBeenNoticed) {
  const Verdict verdict =
      VerdictOfMoves({{"left", {0.002, 0.001, 40}}, {"right", {0.0015, 0.002, 40}}, {"top", {0.001, 0.001, 40}}});
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_THAT(
      verdict.why,
      HasSubstr(" A bump of any sensor by 2 mm or 0.115 deg half-way through a session would have been noticed."));
}

TEST(AssessUnseen, AMoveBeyondTheToleranceThatNothingWouldShowWarnsWithTheNumberOfPlaces) {
  const Verdict verdict =
      VerdictOfMoves({{"left", {0.002, 0.001, 40}}, {"right", {0.008, 0.002, 20}}, {"top", {0.006, 0.001, 20}}});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(
      verdict.why,
      "A bump of right and top half-way through the session of 2026-01-31 12:00 UTC would go unseen, of right by up "
      "to 8 mm or 0.115 deg (limit 5 mm).");
  EXPECT_EQ(verdict.what_to_do, "Capture at least 62 places that right sees (this session had 20).");
}

SessionEstimate NotRefined(std::vector<std::pair<const char*, SmallestMove>> moves) {
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, '1'));
  estimate.why_not = {{"no_boards", "no camera saw a board", "Show it one."}};
  for (const auto& [sensor, move] : moves) estimate.by_pairs.push_back({SensorId(sensor), move});
  return estimate;
}

TEST(AssessUnseen, ASessionThatIsNotRefinedTellsByItsPairs) {
  const Rig rig;
  const SessionTimes times = {{SessionId(std::string(64, '1')), ParseIso("2026-01-31T12:00:00Z").value()}};
  const auto verdict_of = [&](const SessionEstimate& estimate) {
    return Assess(rig.edges, rig.solution, {}, times, {estimate});
  };
  const Verdict sees = verdict_of(
      NotRefined({{"left", {0.002, 0.001, 40}}, {"right", {0.0015, 0.002, 40}}, {"top", {0.001, 0.001, 40}}}));
  EXPECT_EQ(sees.level, VerdictLevel::kPass);
  EXPECT_THAT(sees.why, HasSubstr("A bump of any sensor by 2 mm or 0.115 deg"));
  const Verdict sees_little = verdict_of(NotRefined({{"left", {0.018, 0.001, 40}}, {"right", {0.018, 0.001, 40}}}));
  EXPECT_EQ(sees_little.level, VerdictLevel::kWarn);
  EXPECT_THAT(sees_little.why, HasSubstr("A bump of left and right half-way through the session"));
  EXPECT_THAT(sees_little.what_to_do, HasSubstr("show a board to a camera beside left"));
  SessionEstimate bumped = NotRefined({{"left", {0.002, 0.001, 40}}});
  bumped.moved = {
      {SensorId("left"), CaptureId("07"), CaptureId("08"), Vector6d::Constant(0.02), 1e-9, {}, SensorId("right")}};
  const Verdict told = verdict_of(bumped);
  EXPECT_EQ(told.level, VerdictLevel::kFail);
  EXPECT_THAT(told.why,
              HasSubstr("left or right was moved during the session of 2026-01-31 12:00 UTC, between captures "
                        "07 and 08, by roughly 34.6 mm"));
  EXPECT_EQ(Judge(rig.edges, rig.solution, {}, times, {bumped}).basis.decided_by.name, "left or right moved by");
  const Verdict sees_nothing = verdict_of(NotRefined({{"left", {}}, {"right", {}}}));
  EXPECT_EQ(sees_nothing.level, VerdictLevel::kWarn);
}

// Two numbers in one breath would leave it open which of them is enough.
TEST(AssessUnseen, CapturesAreAskedForOnceByTheLargestNumber) {
  Rig rig;
  for (int k = 0; k < 8; ++k) rig.edges[0].captures.push_back({CaptureId("c" + std::to_string(k)), 0.2, true, ""});
  const auto judged = [&](std::int64_t captures_min) {
    Policy policy;
    policy.captures_min = captures_min;
    return Judge(rig.edges, rig.solution, policy, {}, {SessionOfMoves({{"right", {0.008, 0.002, 20}}})});
  };
  const Judgement few = judged(9), many = judged(100);
  EXPECT_THAT(few.verdict.why, HasSubstr("too few captures (8, limit 9); also, a bump of right"));
  EXPECT_EQ(few.verdict.what_to_do,
            "Capture at least 62 places that right sees (this session had 20), 9 or more of them of each pair.");
  EXPECT_EQ(many.verdict.what_to_do, "Take 100 captures or more of each pair.");
  ASSERT_EQ(few.basis.reasons.size(), 2U);
  EXPECT_EQ(few.basis.reasons[0].what_to_do, few.verdict.what_to_do);
  EXPECT_EQ(few.basis.reasons[1].what_to_do, "");
}

TEST(AssessUnseen, NobodyIsAskedForThousandsOfPlaces) {
  const Verdict verdict =
      VerdictOfMoves({{"left", {0.002, 0.001, 40}}, {"right", {0.038, 0.002, 24}}, {"top", {0.002, 0.001, 20}}});
  EXPECT_THAT(verdict.what_to_do,
              HasSubstr("Capture again with boards nearer to right and more tilted (more places alone: "));
  EXPECT_THAT(verdict.what_to_do, HasSubstr(" instead of 24)."));
}

TEST(AssessUnseen, ASensorThatNoSessionTellsOfIsNamed) {
  EXPECT_THAT(
      VerdictOfMoves({{"left", {0.002, 0.002, 40}}, {"top", {0.001, 0.001, 40}}}).why,
      HasSubstr(" A bump of any sensor but right by 2 mm or 0.115 deg half-way through a session would have been "
                "noticed; of right it is not known."));
}

// Such as a session of lidars alone.
TEST(AssessUnseen, ASessionThatWasJudgedPairByPairSaysThatMovesAreNotKnown) {
  const Rig rig;
  SessionEstimate estimate = SessionOfMoves({});
  estimate.why_not.push_back({NameOf(ErrorCode::kInvalidInput), "the session has no picture of a board", "-"});
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {estimate});
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_THAT(verdict.why,
              HasSubstr("Whether a sensor was bumped during the newest session is not known: it was judged "
                        "pair by pair only, as the session has no picture of a board."));
}

// That an older session would have shown a bump says nothing of the newest.
TEST(AssessUnseen, OfTheNewestSessionNothingIsClaimedThatAnOlderOneTells) {
  const Rig rig;
  SessionEstimate newest = SessionOfMoves({});
  newest.session = SessionId(std::string(64, '2'));
  newest.why_not.push_back({NameOf(ErrorCode::kInvalidInput), "the session has no picture of a board", "-"});
  const SessionEstimate older =
      SessionOfMoves({{"left", {0.002, 0.001, 40}}, {"right", {0.0015, 0.002, 40}}, {"top", {0.001, 0.001, 40}}});
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {newest, older});
  EXPECT_THAT(verdict.why, HasSubstr("Whether a sensor was bumped during the newest session is not known"));
}

TEST(AssessUnseen, OnlySensorsOfTheWorstSessionAreGivenToIt) {
  const Rig rig;
  SessionEstimate other = SessionOfMoves({{"left", {0.006, 0.002, 20}}});
  other.session = SessionId(std::string(64, '2'));
  const Verdict verdict =
      Assess(rig.edges, rig.solution, {}, {}, {SessionOfMoves({{"right", {0.008, 0.002, 20}}}), other});
  EXPECT_THAT(verdict.why, HasSubstr("A bump of right by up to 8 mm"));
  EXPECT_THAT(verdict.why, testing::Not(HasSubstr("left")));
}

TEST(AssessUnseen, ASessionWhoseRefinementFailedIsNoPass) {
  const Rig rig;
  SessionEstimate failed;
  failed.session = SessionId(std::string(64, '2'));
  failed.why_not.push_back({kRefinementFailed, "the joint refinement reached no minimum", "More captures."});
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {failed});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why,
              HasSubstr("could not be refined as a whole (the joint refinement reached no minimum): a bump "
                        "during it would go unseen"));
  const SmallestMove small{0.001, 0.001, 40};
  const auto whole = SessionOfMoves({{"left", small}, {"right", small}, {"top", small}});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {failed, whole}).level, VerdictLevel::kWarn);
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {whole, failed}).level, VerdictLevel::kPass);
  failed.why_not.front().code = "invalid_input";
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {failed}).level, VerdictLevel::kPass);
}

TEST(AssessUnseen, OneSensorIsToldWithItsSize) {
  EXPECT_EQ(VerdictOfMoves({{"right", {0.008, 0.002, 20}}}).why,
            "A bump of right by up to 8 mm or 0.115 deg (limit 5 mm) half-way through the session of 2026-01-31 12:00 "
            "UTC would go "
            "unseen.");
}

TEST(AssessUnseen, WhereNoMoveWouldShowNoSizeIsTold) {
  const Verdict verdict = VerdictOfMoves({{"right", {kAnyMove_m, kAnyMove_rad, 5}}});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why, "A bump of right half-way through the session of 2026-01-31 12:00 UTC would go unseen.");
  EXPECT_EQ(verdict.what_to_do, "Capture more than 5 places that right sees.");
}

TEST(AssessUnseen, TheNewestSessionOfASensorCounts) {
  const Rig rig;
  const auto blind = SessionOfMoves({{"right", {0.5, 0.5, 6}}}),
             sharp = SessionOfMoves({{"right", {0.001, 0.001, 60}}});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {sharp, blind}).level, VerdictLevel::kPass);
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {blind, sharp}).level, VerdictLevel::kWarn);
}

TEST(AssessMovedBoard, OneOfTheNewestSessionWarnsByNameAndCapture) {
  const Rig rig;
  SessionEstimate moved = SessionOfMoves({{"left", {0.001, 0.001, 40}}});
  moved.boards_moved.push_back({TargetId("wall"), CaptureId("019"), CaptureId("020"), Vector6d::Unit(0) * 0.005, 1e-9});
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {moved});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("oard wall was moved during the session of"));
  EXPECT_THAT(verdict.why, HasSubstr("between captures 019 and 020, by 5 mm and 0 deg"));
  SessionEstimate later = SessionOfMoves({{"left", {0.001, 0.001, 40}}});
  later.session = SessionId(std::string(64, '2'));
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {later, moved}).level, VerdictLevel::kPass);
}

TEST(AssessMovedBoard, TheOriginOfATrackersPosesIsNoMoveOfItsBody) {
  const Rig rig;
  SessionEstimate moved = SessionOfMoves({{"left", {0.001, 0.001, 40}}});
  moved.boards_moved.push_back(
      {{}, CaptureId("019"), CaptureId("020"), Vector6d::Unit(0) * 0.005, 1e-9, {}, SensorId("mast")});
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {moved});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("he poses that mast tells jumped during the session of"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("see that mast keeps the origin of its poses"));
}

}  // namespace
}  // namespace rigcal::fleet
