// What is said of findings that are made up: sentences, numbers, order.
#include <gmock/gmock.h>

#include <sstream>

#include "client/check/report.h"
#include "client/text/document.h"
#include "tests/unit/client/check/made_findings.h"

namespace rigcal::check {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Without what its last axis says.
Edge PlanarEdge() {
  Edge edge = GoodEdge(0.001, 0.001);
  Matrix6d Omega = edge.uncertainty.Omega;
  Omega(2, 2) = 0;
  edge.uncertainty = FromInformation(Omega, UncertaintySource::kJackknife, 10);
  edge.diagnoses = {{"planar_motion", "left and body were turned about one axis.", "Turn the robot about two axes."}};
  return edge;
}

TEST(CheckAdvice, AGoodSessionIsEnough) {
  const Judgement judgement = JudgeFindings(TwoCameras());
  EXPECT_TRUE(judgement.IsEnough()) << TextsOf(judgement).front();
  EXPECT_EQ(Headline(judgement), "Enough.");
  EXPECT_THAT(judgement.remarks, IsEmpty());
}

TEST(CheckAdvice, APairWithFewCapturesSaysHowMany) {
  const Judgement judgement = JudgeFindings(TwoCameras(3));
  ASSERT_EQ(judgement.advice.size(), 1u);
  EXPECT_THAT(judgement.advice[0].of, ElementsAre("left - right"));
  EXPECT_EQ(judgement.advice[0].text, "both see the board in 3 different captures, 20 are wanted: take 17 more");
  EXPECT_EQ(judgement.advice[0].urgency, Urgency::kFew);
  EXPECT_EQ(Headline(judgement), "Take 17 more captures.");
  const Judgement none = JudgeFindings(TwoCameras(0));
  EXPECT_EQ(none.advice[0].text, "both see the board in no capture, 20 are wanted: take 20 more");
  EXPECT_EQ(none.advice[0].urgency, Urgency::kNoAnswer);
  EXPECT_EQ(Headline(JudgeFindings(TwoCameras(7))), "Take 13 more captures.");
}

TEST(CheckAdvice, ACameraWithFewBoardsExplainsItsPairs) {
  Findings findings = TwoCameras(2);
  findings.sensors[0].usable = 2;
  findings.cameras[SensorId("left")].with_board = Captures(2);
  const Judgement judgement = JudgeFindings(findings);
  ASSERT_EQ(judgement.advice.size(), 1u);
  EXPECT_THAT(judgement.advice[0].of, ElementsAre("left"));
  EXPECT_EQ(judgement.advice[0].text,
            "the board is in 2 of 12 pictures, 20 are wanted: take 18 more with the board in view");
  EXPECT_EQ(judgement.advice[0].urgency, Urgency::kNoAnswer);
}

TEST(CheckAdvice, ACameraThatNeverSawTheBoardSaysWhy) {
  Findings findings = TwoCameras(0);
  findings.sensors[0].usable = 0;
  findings.cameras[SensorId("left")].with_board.clear();
  findings.cameras[SensorId("left")].why_not = "no 9 x 6 board in the picture";
  EXPECT_THAT(
      TextsOf(JudgeFindings(findings)),
      ElementsAre("no board in 12 pictures (no 9 x 6 board in the picture), 20 are wanted: take 20 more with the "
                  "board in view"));
}

TEST(CheckAdvice, WhatIsSaidAlikeOfSeveralIsSaidOnce) {
  Findings findings = TwoCameras(3);
  for (std::size_t i : {0, 1}) findings.sensors[i].usable = 3, findings.sensors[i].files = 3;
  const Judgement judgement = JudgeFindings(findings);
  ASSERT_EQ(judgement.advice.size(), 1u);
  EXPECT_THAT(judgement.advice[0].of, ElementsAre("left", "right"));
}

TEST(CheckAdvice, ASensorWithoutFilesIsNoReasonToTakeMore) {
  Findings findings = TwoCameras(0);
  findings.sensors[1].files = findings.sensors[1].usable = 0;
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(TextsOf(judgement),
              ElementsAre("no files: put its pictures into right/, or take it out of session.yaml"));
  EXPECT_EQ(Headline(judgement), "Not enough yet.");
}

TEST(CheckAdvice, WhatNothingChecksIsARemark) {
  Findings findings = TwoCameras();
  findings.pairs[0].is_checked = false;
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_TRUE(judgement.IsEnough());
  ASSERT_EQ(judgement.remarks.size(), 1u);
  EXPECT_THAT(judgement.remarks[0], testing::StartsWith("No loop of pairs checks the result: more captures do not"));
}

TEST(CheckAdvice, AFailedPairHasTheServersSentence) {
  Findings findings = TwoCameras();
  findings.pairs[0].edge = Edge{};
  findings.pairs[0].edge->diagnoses = {{"high_residual", "left and right fit badly.", "Check the board."}};
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(TextsOf(judgement), ElementsAre("left and right fit badly. Check the board."));
  EXPECT_EQ(judgement.advice[0].urgency, Urgency::kNoAnswer);
}

TEST(CheckAdvice, APairLessSureThanTheFleetWantsTakesMore) {
  const Judgement judgement = JudgeFindings(TwoCameras(12, 0.006));
  ASSERT_EQ(judgement.advice.size(), 1u);
  EXPECT_THAT(judgement.advice[0].text, HasSubstr("known to 6.0 mm and 0.01 deg only, 5 mm and 0.29 deg are wanted"));
  EXPECT_EQ(judgement.advice[0].captures_more, 6u);  // 12 (1.2^2 - 1) = 5.3
  EXPECT_EQ(JudgeFindings(TwoCameras(12, 0.1)).captures_more, 12u);
}

TEST(CheckAdvice, ALensThatIsEstimatedWantsTheEdgesOfThePicture) {
  Findings findings = TwoCameras();
  CameraFound& left = findings.cameras[SensorId("left")];
  left.coverage.margin_ratio = {0.3, 0.05, 0.2, 0.0};
  EXPECT_TRUE(JudgeFindings(findings).IsEnough()) << "a given lens need not be covered";
  left.estimates_lens = true;
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(TextsOf(judgement), ElementsAre("hold the board near the left and top edge of its picture"));
  EXPECT_EQ(Headline(judgement), "Take 2 more captures.");
  left.fills_picture = false;
  EXPECT_TRUE(JudgeFindings(findings).IsEnough()) << "a fisheye's picture has dark sides";
  left.fills_picture = true;
  left.coverage.margin_ratio = {};
  left.coverage.share_ratio = 0.3;
  EXPECT_THAT(TextsOf(JudgeFindings(findings)),
              ElementsAre("hold the board in every part of its picture, of which corners cover 30 %"));
}

TEST(CheckAdvice, AFocalLengthThatIsOpenWantsTilts) {
  Findings findings = TwoCameras();
  CameraFound& left = findings.cameras[SensorId("left")];
  left.estimates_lens = true;
  left.focal_sigma_ratio = 0.001;
  EXPECT_TRUE(JudgeFindings(findings).IsEnough());
  left.focal_sigma_ratio = 0.012;
  left.ring.views = {0, 5, 1, 2};
  left.distances = BoardDistances{2.0, 2.1};
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(TextsOf(judgement), ElementsAre("its focal length is known to 1.2 % only: tilt the board 30 degrees left "
                                              "and up, and hold it nearer and farther"));
  EXPECT_EQ(judgement.captures_more, 2u);
}

TEST(CheckAdvice, BoardsThatAllStandAlikeFailAndSayWhichWayToTilt) {
  Findings findings = TwoCameras();
  CameraFound& left = findings.cameras[SensorId("left")];
  left.estimates_lens = true;
  left.ring.views = {};
  left.lens_problem = Diagnosis{"no_tilt", "The boards differ by at most 2 deg.", "Tilt the board."};
  EXPECT_TRUE(JudgeFindings(findings).IsEnough()) << "two cameras told what one does not";
  findings.pairs[0].edge = Edge{};
  findings.pairs[0].edge->diagnoses = {{"no_tilt", "The boards differ by at most 2 deg.", "Tilt the board."}};
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(TextsOf(judgement),
              ElementsAre("its boards stand too much alike to tell its focal length: tilt the board "
                          "30 degrees left, right, up and down"));
  EXPECT_EQ(Headline(judgement), "Take 4 more captures.");
}

TEST(CheckAdvice, BlurredPicturesDoNotCountButAreNamed) {
  Findings findings = TwoCameras();
  CameraFound& left = findings.cameras[SensorId("left")];
  left.blurred = {{CaptureId("03"), 7.25}};
  Judgement judgement = JudgeFindings(findings);
  EXPECT_TRUE(judgement.IsEnough());
  EXPECT_THAT(judgement.remarks,
              ElementsAre("left: blurred at the edges of the board: 03 (7.2 px); its usual edge is 2.4 px wide."));
  left.blurred.resize(6, {CaptureId("04"), 8.0});
  judgement = JudgeFindings(findings);
  ASSERT_EQ(judgement.advice.size(), 1u);
  EXPECT_THAT(judgement.advice[0].text, HasSubstr("6 of 12 pictures of the board are blurred"));
  EXPECT_EQ(judgement.captures_more, 14u);
}

TEST(CheckAdvice, AnOpenDirectionMattersWhereNoOtherPairClosesIt) {
  Findings findings = TwoCameras();
  SensorFiles body;
  body.sensor = SensorId("body");
  body.kind = SensorKind::kTracker;
  body.files = 1, body.usable = 12, body.present = Captures(12);
  findings.sensors.push_back(body);
  AddPair("left", "body", Method::kTrackerCamera, 12, PlanarEdge(), findings);
  const Judgement open = JudgeFindings(findings);
  EXPECT_THAT(
      TextsOf(open),
      ElementsAre("turned about one axis only: how far they are from each other along it is not known. Turn the "
                  "robot about two axes."));
  EXPECT_EQ(Headline(open), "Not enough yet.");
  AddPair("right", "body", Method::kTrackerCamera, 12, GoodEdge(0.001, 0.001), findings);
  EXPECT_TRUE(JudgeFindings(findings).IsEnough());
}

void AddLidar(std::size_t clouds, Findings& findings) {
  SensorFiles files;
  files.sensor = SensorId("top");
  files.kind = SensorKind::kLidar;
  files.files = files.usable = clouds, files.present = Captures(clouds);
  findings.sensors.push_back(files);
  findings.lidars.push_back({files.sensor, clouds, 1000, 1000, {}});
  AddPair("left", "top", Method::kLidarCamera, clouds, std::nullopt, findings);
  AddPair("right", "top", Method::kLidarCamera, clouds, std::nullopt, findings);
}

TEST(CheckAdvice, WhatWasOnlyCountedIsNotSaidToBeEnough) {
  Findings findings = TwoCameras();
  AddLidar(12, findings);
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_TRUE(judgement.IsEnough());
  EXPECT_EQ(Headline(judgement),
            "Enough, as far as was looked: whether the clouds of top show the board is found after the push.");
}

TEST(CheckAdvice, CountedPairsMayCloseADirectionButNeedNot) {
  Findings findings = TwoCameras();
  AddLidar(12, findings);
  findings.pairs[0].edge = PlanarEdge();
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_TRUE(judgement.IsEnough());
  EXPECT_THAT(judgement.remarks,
              ElementsAre("left - right leaves a direction open; pairs with a lidar, whose clouds were "
                          "not looked at, may close it."));
}

// Pictures 01 to 07 of one camera and 08 to 14 of the other: the pair wants more than each of them.
TEST(CheckAdvice, ASensorsAdviceDoesNotHideAPairThatWantsMore) {
  Findings findings = TwoCameras(0);
  findings.pairs[0].edge = Edge{};
  for (std::size_t i : {0, 1}) findings.sensors[i].usable = 7;
  const Judgement judgement = JudgeFindings(findings);
  ASSERT_EQ(judgement.advice.size(), 2u);
  EXPECT_THAT(judgement.advice[0].of, ElementsAre("left - right"));
  EXPECT_THAT(judgement.advice[1].of, ElementsAre("left", "right"));
  EXPECT_EQ(Headline(judgement), "Take at least 20 more captures.");
}

TEST(CheckAdvice, TwoThatNeverSeeTheBoardTogetherAreLeftToTheOthers) {
  Findings findings = TwoCameras();
  AddCamera("back", 12, 12, findings);
  AddPair("right", "back", Method::kStereo, 12, GoodEdge(0.0002, 1e-4), findings);
  AddPair("left", "back", Method::kStereo, 0, Edge{}, findings);
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_TRUE(judgement.IsEnough());
  EXPECT_THAT(judgement.remarks, ElementsAre("left - back have no capture in common: nothing comes of this pair; "
                                             "`skip_pairs` in session.yaml leaves it out."));
}

TEST(CheckAdvice, TheWorstComesFirst) {
  Findings findings = TwoCameras(6);
  AddCamera("top", 1, 12, findings);
  AddPair("left", "top", Method::kStereo, 1, Edge{}, findings);
  findings.cameras[SensorId("left")].estimates_lens = true;
  findings.cameras[SensorId("left")].coverage.margin_ratio = {0.3, 0, 0, 0};
  const Judgement judgement = JudgeFindings(findings);
  ASSERT_EQ(judgement.advice.size(), 3u);
  EXPECT_THAT(judgement.advice[0].of, ElementsAre("top"));
  EXPECT_THAT(judgement.advice[1].of, ElementsAre("left - right"));
  EXPECT_THAT(judgement.advice[2].of, ElementsAre("left"));
  EXPECT_EQ(Headline(judgement), "Take at least 19 more captures.");
}

TEST(CheckAdvice, ASessionWithoutPairsIsNotEnough) {
  Findings findings;
  findings.robot = RobotId("r1");
  AddCamera("left", 12, 12, findings);
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_FALSE(judgement.IsEnough());
  EXPECT_THAT(judgement.remarks, ElementsAre("left is in no pair of sensors that is calibrated."));
}

TEST(CheckAdvice, RemarksNameFiles) {
  Findings findings = TwoCameras();
  findings.sensors[0].present = Captures(11);
  findings.sensors[0].unreadable = {{"left/03.png", "the picture is cut off; save or copy the picture again"}};
  findings.cameras[SensorId("right")].resized = {CaptureId("02")};
  findings.cameras[SensorId("right")].without_board = {CaptureId("04"), CaptureId("05"), CaptureId("06")};
  findings.cameras[SensorId("right")].why_not = "no 9 x 6 board in the picture";
  findings.same_files = {{"left/01.png", "right/01.png"}};
  findings.streams = {{SensorId("vio"), 100, 41.0, 1, 2.3}};
  EXPECT_THAT(JudgeFindings(findings).remarks,
              ElementsAre("left has files for 11 of 12 captures: 12 is missing.",
                          "left/03.png: the picture is cut off; save or copy the picture again.",
                          "right: no board in 04 to 06 (no 9 x 6 board in the picture).",
                          "right: the pictures of 02 are not of 640 x 480 pixels like the others: take all pictures of "
                          "one camera at one size.",
                          "vio has 1 gap without a pose in its 41 s, the longest of 2.3 s: nothing is known there.",
                          "left/01.png and right/01.png are one and the same file: copy each sensor's own, or take the "
                          "capture again."));
}

TEST(CheckReport, TellsTheVerdictFirst) {
  const Findings findings = TwoCameras(3);
  std::ostringstream out;
  PrintReport(findings, JudgeFindings(findings), out);
  EXPECT_THAT(out.str(),
              testing::StartsWith("r1, captured 1 Jan 1970: 2 sensors, 12 captures, 24 pictures, 0 clouds\n"
                                  "verdict  Take 17 more captures.\n"
                                  "         left - right: both see the board in 3 different captures, 20 are "
                                  "wanted: take 17 more.\n"));
  EXPECT_THAT(out.str(),
              HasSubstr("\nlimits   Judged by the default limits, 5 mm and 0.29 deg: the server's policy may "
                        "want more.\n"));
  EXPECT_THAT(out.str(), HasSubstr("Pairs, as the server will find them"));
  EXPECT_THAT(out.str(), HasSubstr("0.20"));
}

TEST(CheckReport, IsOneObject) {
  Findings findings = TwoCameras(3);
  findings.refusals = {{ErrorCode::kInvalidInput, "file \"left/04.png\": it is empty", "Remove the file."}};
  const auto document = client::Document::Parse(ReportJson(findings, JudgeFindings(findings)), "check");
  ASSERT_TRUE(document);
  EXPECT_FALSE((*document)["enough"].Flag(true));
  EXPECT_EQ((*document)["captures_more"].Integer(), 17);
  EXPECT_EQ((*document)["advice"][0]["of"][0].Text(), "left - right");
  EXPECT_EQ((*document)["refused"][0]["cure"].Text(), "Remove the file.");
  EXPECT_EQ((*document)["limits"]["tolerance_m"].Number(), 0.005);
  EXPECT_EQ((*document)["cameras"].size(), 2u);
  EXPECT_EQ((*document)["pairs"][0]["state"].Text(), "good");
  EXPECT_NEAR(*(*document)["pairs"][0]["sigma_m"][0].Number(), 0.0002, 1e-9);
}

}  // namespace
}  // namespace rigcal::check
