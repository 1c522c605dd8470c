// What a technician reads on the page of a revision.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "server/model/edges/past.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportRevision, FolderHasPageDocumentAndStyle) {
  const auto files = RenderRevision(SampleReport(), "{\"robot\":1}").value();
  ASSERT_EQ(files.size(), 6U);
  EXPECT_THAT(files.at("data.js"), ::testing::StartsWith("window.rigcal = {"));
  EXPECT_THAT(files.at("edges.csv"), ::testing::StartsWith("frame_a,frame_b,state,"));
  EXPECT_EQ(files.at("revision.json"), "{\"robot\":1}");
  EXPECT_EQ(files.at("style.css"), StyleSheet());
  EXPECT_THAT(files.at("style.css"), HasSubstr("prefers-color-scheme: dark"));
  EXPECT_THAT(files.at("index.html"), HasSubstr("href=\"revision.json\""));
}

TEST(ReportRevision, VerdictSaysWhyAndWhatToDo) {
  const std::string banner = Between(PageOf(SampleReport()), "<section class=\"banner warn\"", "</section>");
  EXPECT_THAT(banner, HasSubstr("One edge failed: front_left to rear"));
  EXPECT_THAT(banner, HasSubstr("Repeat the session for front_left and rear"));
}

TEST(ReportRevision, TheDriveRuleComesFirstAndLimitsStandBesideSigmas) {
  ReportInput input = SampleReport();
  input.calibrated_at = *ParseIso("2026-11-22T08:00:00Z");
  input.revision.verdict = {VerdictLevel::kPass, "All is well.", "Nothing."};
  std::string banner = Between(PageOf(input), "<section class=\"banner pass\"", "</section>");
  EXPECT_LT(banner.find("OK to drive until 20 Feb 2027."), banner.find("class=\"word then\""));
  input.max_age_ns = 10LL * 86'400'000'000'000;
  EXPECT_THAT(PageOf(input), HasSubstr("OK to drive until 2 Dec 2026."));
  EXPECT_THAT(RowOf(PageOf(input), "front_right"), HasSubstr("<td class=\"text limit\"></td>")) << "nobody kept it";
  input.revision.policy = PolicyInForce{};
  input.revision.policy->policy.sensors[SensorId("front_right")].tolerance_m = 0.002;
  EXPECT_THAT(RowOf(PageOf(input), "front_right"), HasSubstr("<td class=\"text limit\">2.0 mm, 0.29 deg</td>"));
  std::erase_if(input.revision.solution.poses, [](const SensorPose& pose) { return !pose.known; });
  EXPECT_TRUE(PageOf(input).find(" mm (limit 5.0 mm), ") != std::string::npos) << "of the worst sensor";
  input.revision.verdict.level = VerdictLevel::kFail;
  EXPECT_THAT(PageOf(input), HasSubstr("<p class=\"drive\" dir=\"auto\">Do not drive.</p>"));
}

TEST(ReportRevision, PastEdgesComeLastAndHaveNotFailed) {
  ReportInput input = SampleReport();
  const std::string before = PageOf(input);
  Edge past = FailedEdge();
  past.frame_b = SensorId("front_right");
  past.id = EdgeId(Sha256Of("past").str());
  past.diagnoses = {{std::string(kRemountedCode), "sensor front_right was remounted", "Measure it anew."}};
  input.revision.edges.push_back(past);
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("1 failed, 1 past"));
  EXPECT_THAT(page, HasSubstr("<span class=\"badge unknown\">past</span>"));
  const auto count = [](const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count(page, "<path"), count(before, "<path"));  // no line of the drawing
  EXPECT_GT(page.rfind("badge unknown\">past<"), page.rfind("badge pass\">good<"));
  EXPECT_THAT(RenderRevision(input, "{}").value().at("edges.csv"), HasSubstr("front_left,front_right,past,"));
}

TEST(ReportRevision, ErrorOnOneAxisIsShownAtThatAxis) {
  for (int axis = 0; axis < 6; ++axis) {
    ReportInput input = SampleReport();
    SensorPose& pose = input.revision.solution.poses[1];
    pose.covariance = Matrix6d::Identity() * 1e-12;
    pose.covariance(axis, axis) = std::pow(axis < 3 ? 0.0425 : 0.0425 * M_PI / 180 * 1000, 2);
    const std::string row = RowOf(PageOf(input), "front_right");
    std::vector<std::string> sigmas;
    const std::regex cell("<td class=\"sigma\">([^<]*)</td>");
    for (std::sregex_iterator it(row.begin(), row.end(), cell), end; it != end; ++it) sigmas.push_back((*it)[1]);
    ASSERT_EQ(sigmas.size(), 6U);
    for (int other = 0; other < 6; ++other)
      EXPECT_EQ(sigmas[static_cast<std::size_t>(other)] == "42" || sigmas[static_cast<std::size_t>(other)] == "43",
                other == axis)
          << "axis " << axis << " cell " << other << ": " << sigmas[static_cast<std::size_t>(other)];
  }
}

TEST(ReportRevision, PoseIsInMillimetresAndDegrees) {
  ReportInput input = SampleReport();
  SensorPose& pose = input.revision.solution.poses[1];
  pose.T_ref_sensor.p_m = {0.0111, -0.0222, 0.0333};
  pose.T_ref_sensor.q = Eigen::AngleAxisd(M_PI / 6, Eigen::Vector3d::UnitY());
  EXPECT_THAT(RowOf(PageOf(input), "front_right"),
              HasSubstr("<td>11.10</td><td>-22.20</td><td>33.30</td><td>0.000</td><td>30.000</td><td>0.000</td>"));
}

TEST(ReportRevision, UnknownSensorHasWordAndReasonButNoNumber) {
  ReportInput input = SampleReport();
  input.revision.solution.poses[5].T_ref_sensor.p_m.x() = 12.345;
  const std::string row = RowOf(PageOf(input), "tracker");
  EXPECT_THAT(row, HasSubstr("unknown"));
  EXPECT_THAT(row, HasSubstr("no edge names it"));
  EXPECT_THAT(row, Not(HasSubstr("12345")));
}

TEST(ReportRevision, ReasonsOfUnknownSensorsDiffer) {
  ReportInput input = SampleReport();
  AddPose(input.revision, "far_a", false, Se3(), 0);
  AddPose(input.revision, "far_b", false, Se3(), 0);
  AddPose(input.revision, "lonely", false, Se3(), 0);
  input.revision.solution.poses[4].known = false;  // top: reached by a good edge all the same
  input.revision.edges.push_back(SampleEdge("far_a", "far_b", Se3()));
  Edge failed = SampleEdge("lidar", "lonely", Se3());
  failed.state = EdgeState::kFailed;
  input.revision.edges.push_back(failed);
  const std::string page = PageOf(input);
  EXPECT_THAT(RowOf(page, "far_a"), HasSubstr("joined only to far_b"));
  EXPECT_THAT(RowOf(page, "lonely"), HasSubstr("every edge to it failed: lidar"));
  EXPECT_THAT(RowOf(page, "top"), HasSubstr("free"));
}

TEST(ReportRevision, UnobservableAxisIsFreeAndNeverANumber) {
  const std::string page = PageOf(SampleReport());
  const std::string section = Between(page, "Pose of top in front_right", "</table>");
  EXPECT_THAT(RowOf(section, "z, yaw"), HasSubstr("<td>free</td>"));
  EXPECT_THAT(RowOf(section, "x, roll"), Not(HasSubstr("free")));
  EXPECT_THAT(page, HasSubstr("5 of 6 directions are observed; free: z."));
}

// An edge without a residual has no axes to look at, and one sentence in place of a line per capture.
TEST(ReportRevision, AnEdgeThatUsedNoCaptureSaysSoOnce) {
  ReportInput input = SampleReport();
  input.revision.edges = {FailedEdge()};
  EXPECT_NE(PageOf(input).find("Residual of each capture"), std::string::npos);
  for (CaptureResidual& capture : input.revision.edges[0].captures) capture.used = false, capture.note = "not solved";
  const std::string page = PageOf(input);
  EXPECT_EQ(page.find("Residual of each capture"), std::string::npos);
  EXPECT_NE(page.find("None of the 3 captures was used: not solved."), std::string::npos);
  EXPECT_EQ(page.find("was not used: not solved"), std::string::npos);
}

// What a pair of a very large session left to the refinement is one sentence; an outlier beside it has its own.
TEST(ReportRevision, CapturesLeftToTheRefinementAreOneSentence) {
  ReportInput input = SampleReport();
  auto good = std::find_if(input.revision.edges.begin(), input.revision.edges.end(),
                           [](const Edge& edge) { return edge.state == EdgeState::kGood; });
  ASSERT_NE(good, input.revision.edges.end());
  for (int i = 0; i < 50; ++i)
    good->captures.push_back(
        {CaptureId("a" + std::to_string(i)), 0.0, false, std::string(kLeftToRefinement) + ": the pair uses 120"});
  good->captures.push_back({CaptureId("z"), 0.0, false, "it contradicts the others"});
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr(">50 captures are left to the joint refinement: the pair uses 120.<"));
  EXPECT_THAT(page, Not(HasSubstr("was not used: left to")));
  EXPECT_THAT(page, HasSubstr("<strong>z</strong> was not used: it contradicts the others."));
}

TEST(ReportRevision, FailedEdgeComesFirstWithReasonAndCure) {
  const std::string page = PageOf(SampleReport());
  const auto failed = page.find("<details class=\"card edge failed\"");
  ASSERT_NE(failed, std::string::npos);
  EXPECT_LT(failed, page.find("<details class=\"card edge good\""));
  EXPECT_THAT(page.substr(failed, 1200), HasSubstr("Only 2 of 9 captures show the board"));
  EXPECT_THAT(page.substr(failed, 1200), HasSubstr("Take at least 6 more captures"));
  const std::string table = Between(page, "id=\"edges\"", "</table>");
  EXPECT_LT(table.find("front_left &rarr; rear"), table.find("front_right &rarr; top"));
}

TEST(ReportRevision, ShowsPicturesThatExistAndSaysWhichAreMissing) {
  const ReportInput input = SampleReport();
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("<img loading=\"lazy\" src=\"evidence/" + input.evidence[0].str() + ".jpg\""));
  const std::string missing = input.revision.edges[0].evidence.back().digest.str();
  EXPECT_THAT(page, Not(HasSubstr(missing)));
  EXPECT_THAT(page, HasSubstr("picture not stored"));
}

TEST(ReportRevision, PicturesOfWhatWasLeftOutComeFirstThenOfTheWorstFit) {
  ReportInput input = SampleReport();
  Edge& edge = input.revision.edges[0];
  edge.captures = {{CaptureId("good"), 0.1, true, ""},
                   {CaptureId("worst"), 0.9, true, ""},
                   {CaptureId("out"), 0.2, false, "blurred"}};
  edge.evidence.clear();
  for (const char* name : {"unheard", "good", "worst", "out"})
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
      edge.evidence.push_back(
          {"picture of " + std::string(name), sensor, CaptureId(name), Sha256Of(name + sensor.str()), "jpg"});
  const std::string page = PageOf(input);
  std::vector<std::size_t> places;
  for (const char* name : {"out", "worst", "good", "unheard"})
    places.push_back(page.find("picture of " + std::string(name)));
  EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
  EXPECT_NE(places.back(), std::string::npos);
}

TEST(ReportRevision, RisingGlobalErrorIsExplained) {
  ReportInput input = SampleReport();
  EXPECT_THAT(PageOf(input), Not(HasSubstr("It rose")));
  input.revision.solution.after.total = 2 * input.revision.solution.before.total;
  EXPECT_THAT(PageOf(input), HasSubstr("It rose"));
}

TEST(ReportRevision, WithoutLoopNothingIsChecked) {
  ReportInput input = SampleReport();
  input.revision.solution.dof = 0;
  input.revision.solution.after.total = 4.56;  // of edges to a sensor without a pose
  EXPECT_THAT(PageOf(input), HasSubstr("fits by construction"));
  EXPECT_THAT(PageOf(input), Not(HasSubstr("4.56")));
}

TEST(ReportRevision, NoNumberThatIsNone) {
  ReportInput input = SampleReport();
  const double nan = std::nan("");
  input.revision.solution.poses[2].covariance.setConstant(nan);
  input.revision.solution.poses[2].T_ref_sensor.p_m.x() = nan;
  input.revision.solution.residuals[0].e.setConstant(nan);
  input.revision.solution.residuals[0].weighted = HUGE_VAL;
  input.revision.solution.before.total = nan;
  input.revision.solution.cost = HUGE_VAL;
  input.revision.edges[0].figures["rms_px"] = nan;
  input.revision.edges[0].captures[0].rms = nan;
  const std::string page = PageOf(input);
  EXPECT_FALSE(std::regex_search(page, std::regex("[>\" ](-?nan|-?inf)[<\" ,]")));
}

TEST(ReportRevision, ProvenanceNamesEverything) {
  const ReportInput input = SampleReport();
  const std::string part = Between(PageOf(input), "class=\"card provenance\"", "</section>");
  EXPECT_THAT(part, HasSubstr(input.digest.str()));
  EXPECT_THAT(part, HasSubstr(input.revision.edges[0].session.str()));
  EXPECT_THAT(part, HasSubstr("1 edge pushed as finished results"));
  EXPECT_THAT(part, HasSubstr("2026-01-31 12:00:00 UTC"));
  EXPECT_THAT(part, HasSubstr("0.1.0"));
}

TEST(ReportRevision, ProvenanceSaysWhichBoardsNoSensorSaw) {
  ReportInput input = SampleReport();
  SessionFacts facts;
  facts.id = input.revision.edges[0].session;
  facts.boards = {"panel: checkerboard 9 x 6, 25 mm"};
  facts.boards_perhaps_seen = {"far: checkerboard 7 x 5, 60 mm"};
  facts.boards_unseen = {"spare: checkerboard 8 x 5, 30 mm"};
  input.sessions = {facts};
  const std::string part = Between(PageOf(input), "class=\"card provenance\"", "</section>");
  EXPECT_THAT(part, HasSubstr("<bdi>panel: checkerboard 9 x 6, 25 mm</bdi>"));
  EXPECT_THAT(part, HasSubstr("far: checkerboard 7 x 5, 60 mm (it is not known whether a sensor saw it)"));
  EXPECT_THAT(part, HasSubstr("spare: checkerboard 8 x 5, 30 mm (no sensor saw it)"));
}

// A strict content policy holds, and the folder opens from disk.
TEST(ReportRevision, AnEdgeNamesItsSessionByItsTime) {
  ReportInput input = SampleReport();
  const std::string id = Sha256Of("session").str();
  EXPECT_THAT(PageOf(input), HasSubstr("From session " + id.substr(0, 12) + "."));
  SessionFacts facts;
  facts.id = SessionId(id);
  facts.captured_at = *ParseIso("2026-01-30T09:05:00Z");
  input.sessions = {facts};
  EXPECT_THAT(PageOf(input), HasSubstr("From the session of 2026-01-30 09:05:00 UTC, " + id.substr(0, 12) + "."));
}

TEST(ReportRevision, NoInlineScriptNoInlineStyleNoOutsideLink) {
  const std::string page = PageOf(SampleReport());
  EXPECT_FALSE(std::regex_search(
      page, std::regex("<script(?! defer src=\"[a-z0-9./-]+\"( data-scripts=\"[a-z0-9./ -]+\")?></script>)")));
  EXPECT_THAT(page, Not(HasSubstr("<style")));
  EXPECT_FALSE(std::regex_search(page, std::regex("\\sstyle=")));
  EXPECT_FALSE(std::regex_search(page, std::regex("\\son[a-z]+=")));
  EXPECT_FALSE(std::regex_search(page, std::regex("(href|src)=\"(https?:|//|/)")));
  EXPECT_THAT(StyleSheet(), Not(HasSubstr("http")));
}

TEST(ReportRevision, WhomTheVerdictAccusesIsSelectedAndMarked) {
  ReportInput input = SampleReport();
  input.revision.verdict.why = "Beside front_left, front_right was moved.";
  input.revision.basis.culprits = {SensorId("front_right")};
  EXPECT_THAT(RenderRevision(input, "{}").value().at("data.js"), HasSubstr("\"culprits\":[\"front_right\"]"));
  EXPECT_THAT(PageOf(input), HasSubstr("<tr class=\"culprit\"><th scope=\"row\">front_right</th>"));
  input.revision.basis = {};  // a loop, or a document from before it was kept
  EXPECT_THAT(RenderRevision(input, "{}").value().at("data.js"), Not(HasSubstr("culprit")));
  EXPECT_THAT(PageOf(input), Not(HasSubstr("culprit")));
}

TEST(ReportRevision, WhatDecidesNothingByItselfStandsBelowTheDrawing) {
  const std::string page = PageOf(SampleReport());
  const std::string top = Between(page, "aria-label=\"Key figures\"", "</section>");
  EXPECT_THAT(top, HasSubstr("Worst edge"));
  EXPECT_THAT(top, Not(HasSubstr("per degree of freedom")));
  EXPECT_GT(page.find("per degree of freedom"), page.find("id=\"graph\""));
}

TEST(ReportRevision, AnOpenDirectionIsToldInWordsAndNotAsAVectorAsWell) {
  ReportInput input = SampleReport();
  input.revision.solution.diagnoses = {
      {"not_observable",
       "the pose of sensor rear is not fully determined: its edges leave free translation along (0.05, 0.03, 1.00)",
       "Add an edge."}};
  EXPECT_THAT(PageOf(input), HasSubstr("(0.05, 0.03, 1.00)")) << "nothing else tells it";
  for (SensorPose& pose : input.revision.solution.poses)
    if (pose.sensor == SensorId("rear")) pose.known = false, pose.measured_part = MeasuredPart{};
  EXPECT_THAT(PageOf(input), Not(HasSubstr("(0.05, 0.03, 1.00)")));
}

TEST(ReportRevision, HeavyScriptsWaitForTheFirstContent) {
  const std::string page = PageOf(SampleReport());
  EXPECT_TRUE(
      std::regex_search(page, std::regex("<script defer src=\"assets/later-[0-9a-f]+\\.js\" data-scripts=\"data\\.js "
                                         "assets/charts-[0-9a-f]+\\.js assets/rig-[0-9a-f]+\\.js\">")));
  EXPECT_FALSE(std::regex_search(page, std::regex(" src=\"(data|assets/(charts|rig))")));
}

TEST(ReportRevision, AnchorsOfDrawingAndTableExist) {
  const std::string page = PageOf(SampleReport());
  const std::regex link("href=\"#([^\"]+)\"");
  int links = 0;
  for (std::sregex_iterator it(page.begin(), page.end(), link), end; it != end; ++it, ++links)
    EXPECT_THAT(page, HasSubstr("id=\"" + (*it)[1].str() + "\""));
  EXPECT_EQ(links, 7);  // three edges with details: in the drawing and in the table; the way to the table
}

TEST(ReportRevision, SaysOfASensorThatItGoesOnFromVisitToVisit) {
  ReportInput input = SampleReport();
  SensorPose& refined = input.revision.solution.poses.back();
  refined.covariance = 1e-8 * Matrix6d::Identity();
  refined.fused = FusedPose{refined.T_ref_sensor, Matrix6d::Identity(), 12, 0.0, 0.0};
  input.revision.solution.fused.sessions = {SessionId(std::string(64, 'a')), SessionId(std::string(64, 'b'))};
  EXPECT_THAT(PageOf(input), HasSubstr("<td>within \xCF\x83</td>"));
  refined.fused->walk_m_per_sqrt_day = 1e-4, refined.fused->walk_rad_per_sqrt_day = 2e-4;
  EXPECT_THAT(PageOf(input), HasSubstr("<td>within \xCF\x83; goes on by some 0.55 / 0.063 a month</td>"));
}

TEST(ReportRevision, LensesThatBendAreATableOfWhatWasTried) {
  ReportInput input = SampleReport();
  SensorPose& refined = input.revision.solution.poses.back();
  refined.fused = FusedPose{refined.T_ref_sensor, Matrix6d::Identity(), 1, 0.0, 0.0};
  EXPECT_THAT(PageOf(input), testing::Not(HasSubstr("Lenses that bend")));
  LensMisfit lens;
  lens.camera = SensorId("front_left");
  lens.rms_px = 0.051;
  lens.trial = {0.43,
                false,
                24,
                {{CameraModel::kPinholeRadtan, 0.43},
                 {CameraModel::kPinholeRational, 0.21},
                 {CameraModel::kFisheyeKb4, std::nullopt, true}},
                CameraModel::kPinholeRational};
  input.revision.solution.fused.lenses = {lens};
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("Lenses that bend beyond their model"));
  EXPECT_THAT(page, HasSubstr("<td>0.43</td><td>0.43</td><td>0.21</td><td>turns over</td>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"badge warn\">set pinhole_rational</span>"));
  input.revision.solution.fused.lenses[0].trial = {};
  EXPECT_THAT(PageOf(input), HasSubstr("<td>not tried</td><td>not tried</td><td>not tried</td><td>not tried</td>"));
}

TEST(ReportRevision, SameInputSameBytes) { EXPECT_EQ(PageOf(SampleReport()), PageOf(SampleReport())); }

TEST(ReportRevision, ShowsCloudsAndOverlaysOnlyWhereThereAreSome) {
  ReportInput input = SampleReport();
  EXPECT_THAT(PageOf(input), Not(HasSubstr("Coloured clouds")));
  input.clouds.lidars = {{"top", "003", "cloud/top/front.png", "cloud/top/top.png", "cloud/top/oblique.png",
                          "cloud/top/cloud.ply", "cloud/top/points.bin", 2000, 1500, 3}};
  input.clouds.overlays = {{"left", "top", "003", "overlay/left.jpg", "overlay/left_picture.jpg", 1}};
  input.clouds.notes = {"right/003.png is not shown: it cannot be decoded."};
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("capture 003: 2000 points, 75 % seen by 3 cameras"));
  for (const char* file : {"cloud/top/front.png", "cloud/top/top.png", "cloud/top/oblique.png", "overlay/left.jpg"})
    EXPECT_THAT(page, HasSubstr("src=\"" + std::string(file) + "\"")) << file;
  EXPECT_THAT(page, HasSubstr("href=\"cloud/top/cloud.ply\""));
  EXPECT_THAT(page, HasSubstr("href=\"overlay/left_picture.jpg\""));
  EXPECT_THAT(page, HasSubstr("1 point of top"));
  EXPECT_THAT(page, HasSubstr("right/003.png is not shown"));
}

}  // namespace
}  // namespace rigcal::report
