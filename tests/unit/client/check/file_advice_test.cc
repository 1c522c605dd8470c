// What is said of files that are missing or cannot be read, and of boards that no camera found.
#include <gmock/gmock.h>

#include <sstream>

#include "client/check/report.h"
#include "tests/unit/client/check/made_findings.h"

namespace rigcal::check {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// As a push of the same warns or fails: copied, they are there.
TEST(CheckFileAdvice, FilesThatAreMissingAreToBeCopied) {
  Findings findings = TwoCameras(8);
  findings.sensors[0].files = findings.sensors[0].usable = 8;
  findings.sensors[0].present = Captures(8);
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(TextsOf(judgement),
              ElementsAre("files for 8 of 12 captures: 09 to 12 are missing; unless it took no part "
                          "in these, as in another pass, copy these files into left/, or take "
                          "these captures again"));
  EXPECT_THAT(judgement.advice[0].of, ElementsAre("left"));
  EXPECT_EQ(judgement.captures_more, 0u);
  EXPECT_FALSE(judgement.IsEnough());
  EXPECT_THAT(judgement.remarks, IsEmpty());
  findings.sensors[0].files = findings.sensors[0].usable = 10;
  findings.sensors[0].present = Captures(10);
  EXPECT_TRUE(JudgeFindings(findings).IsEnough()) << "two of twelve are no reason for a push to warn, either";
}

TEST(CheckFileAdvice, WhereCopyingIsNotEnoughTheShortageIsToldToo) {
  Findings findings = TwoCameras(2);
  findings.sensors[0].files = 8;
  findings.sensors[0].usable = 2;
  findings.sensors[0].present = Captures(8);
  findings.pairs[0].needed.enough = 20;
  std::vector<std::string> of_left;
  for (const Advice& advice : JudgeFindings(findings).advice)
    if (advice.of == std::vector<std::string>{"left"}) of_left.push_back(advice.text);
  EXPECT_THAT(of_left, testing::UnorderedElementsAre(HasSubstr("files for 8 of 12 captures: 09 to 12 are missing; "),
                                                     HasSubstr("are wanted: take ")));
}

// Three clouds that are missing have nothing to do with what a pair lacks besides.
TEST(CheckFileAdvice, FilesThatAreMissingHideNoOtherFailure) {
  Findings findings = TwoCameras(2);
  findings.sensors[1].files = findings.sensors[1].usable = 9;
  findings.sensors[1].present = Captures(9);
  findings.pairs[0].needed = {4, 20};
  const auto of_pair = [&] {
    for (const Advice& advice : JudgeFindings(findings).advice)
      if (advice.of == std::vector<std::string>{"left - right"}) return advice.text;
    return std::string();
  };
  EXPECT_THAT(of_pair(), HasSubstr("take 18 more"));
  findings.pairs[0].edge = Edge{};
  findings.pairs[0].edge->state = EdgeState::kFailed;
  findings.pairs[0].edge->diagnoses = {{"no_nominal_pose", "Neither has a nominal pose.", "Add one."}};
  std::ostringstream out;
  PrintReport(findings, JudgeFindings(findings), out);
  EXPECT_THAT(out.str(), HasSubstr("Neither has a nominal pose."));
}

TEST(CheckFileAdvice, CamerasThatRecordedApartLackNothing) {
  Findings findings = TwoCameras();
  findings.sensors[0].present = Captures(5);
  const std::vector<CaptureId> all = Captures(12);
  findings.sensors[1].present = {all.begin() + 5, all.end()};
  EXPECT_THAT(CapturesLacking(findings, findings.sensors[0]), IsEmpty());
}

// Left is in the first pass, right in the second, top in both.
Findings TwoPasses() {
  Findings findings;
  findings.robot = RobotId("r1");
  findings.captures = Captures(40);
  AddCamera("left", 20, 20, findings);
  AddCamera("right", 20, 20, findings);
  AddCamera("top", 40, 40, findings);
  const std::vector<CaptureId> all = Captures(40);
  findings.sensors[1].present = {all.begin() + 20, all.end()};
  findings.cameras[SensorId("right")].with_board = findings.sensors[1].present;
  AddPair("left", "top", Method::kStereo, 20, GoodEdge(0.0002, 1e-4), findings);
  AddPair("right", "top", Method::kStereo, 20, GoodEdge(0.0002, 1e-4), findings);
  return findings;
}

TEST(CheckFileAdvice, WhatAnotherPassRecordedIsNotMissing) {
  Findings findings = TwoPasses();
  EXPECT_TRUE(JudgeFindings(findings).IsEnough());
  EXPECT_THAT(RemarksOf(findings), ElementsAre("left has no files for 21 to 40, which right recorded without it: taken "
                                               "as another pass, nothing is missing there.",
                                               "right has no files for 01 to 20, which left recorded without it: "
                                               "taken as another pass, nothing is missing there."));
  std::erase(findings.sensors[0].present, CaptureId("05"));
  EXPECT_THAT(RemarksOf(findings), testing::Contains("left has files for 19 of 20 captures: 05 is missing."));
  findings.sensors[0].present.resize(14);
  EXPECT_THAT(TextsOf(JudgeFindings(findings)),
              ElementsAre(HasSubstr("files for 14 of 20 captures: 05 and 16 to 20 are missing; copy")));
}

TEST(CheckFileAdvice, OneCaptureTogetherIsNoOtherPass) {
  Findings findings = TwoPasses();
  findings.sensors[1].present.insert(findings.sensors[1].present.begin(), CaptureId("01"));
  const std::vector<CaptureId> lacking = CapturesLacking(findings, findings.sensors[0]);
  EXPECT_EQ(lacking.size(), 40u);
}

TEST(CheckFileAdvice, PicturesThatCannotBeReadAreToBeCopiedAgain) {
  Findings findings = TwoCameras(0);
  findings.pairs[0].edge = Edge{};
  findings.pairs[0].edge->diagnoses = {{"too_few_captures", "left and right see the board in no capture.", "Take 10."}};
  findings.sensors[1].usable = 0;
  for (int i = 0; i < 12; ++i) findings.sensors[1].unreadable.push_back({"right/x.png", "the picture is cut off"});
  findings.cameras[SensorId("right")].with_board.clear();
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(TextsOf(judgement), ElementsAre("12 of 12 pictures cannot be read: copy them again from where they were "
                                              "recorded, or take these captures again"));
  EXPECT_EQ(judgement.captures_more, 0u);
  EXPECT_EQ(Headline(judgement), "Not enough yet.");
  std::ostringstream out;
  PrintReport(findings, judgement, out);
  EXPECT_THAT(out.str(), testing::Not(HasSubstr("Take 10"))) << "what follows from it has another cure";
}

TEST(CheckFileAdvice, ABoardThatNoCameraFoundIsNotHeldUpMoreOften) {
  Findings findings = TwoCameras(0);
  Target board;
  board.id = TargetId("front"), board.cols = 11, board.rows = 7;
  for (auto& [id, camera] : findings.cameras) {
    camera.boards = {{board, 0}};
    camera.without_board = camera.with_board;
    camera.with_board.clear();
  }
  for (SensorFiles& files : findings.sensors) files.usable = 0;
  const Judgement judgement = JudgeFindings(findings);
  ASSERT_EQ(judgement.advice.size(), 1u);
  EXPECT_THAT(judgement.advice[0].of, ElementsAre("left", "right"));
  EXPECT_THAT(judgement.advice[0].text,
              testing::StartsWith("board front with 11 x 7 inner corners was not found in any of the 24 pictures. Open "
                                  "one of the pictures. It is dark, or without board front: "));
  EXPECT_THAT(judgement.advice[0].text, testing::EndsWith("correct `inner_corners` in session.yaml"));
  EXPECT_EQ(judgement.captures_more, 0u);
  findings.cameras[SensorId("right")].boards[0].pictures = 1;
  EXPECT_GT(JudgeFindings(findings).captures_more, 0u) << "described well, it is found by another camera";
}

}  // namespace
}  // namespace rigcal::check
