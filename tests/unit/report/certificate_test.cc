// The page of a certificate: what it looks like. What it says: certificate/content_test.cc.
#include "server/report/pages/certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/robot_pages.h"
#include "tests/unit/report/certificate/sample.h"

namespace rigcal::report {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string CertificateOf(const ReportInput& input) {
  return RenderCertificate(input, StandingWhenDrawn(input), "").value();
}

std::string PoseRowOf(const std::string& page, const std::string& sensor) {
  const auto from = page.find("<th scope=\"row\"><span class=\"name\">" + sensor + "</span></th>");
  return from == std::string::npos ? "" : page.substr(from, page.find("</tr>", from) - from);
}

TEST(CertificatePage, HasAllThatACertificateSays) {
  const std::string page = CertificateOf(CertificateSample());
  for (const char* part :
       {"<h1>Calibration certificate <", "mapper-01", "rig <bdi>mars-mapper</bdi>", "revision 7",
        "Measured 2026-01-30 09:30:00 UTC, solved 2026-01-31 12:00:00 UTC.", "In use: approved by Eve, 1 Feb 2026",
        "board: checkerboard 9 x 6, 25 mm", "conditions: site: hall 3", "rigcald 0.1.0", "As found, as left",
        "Nothing was in use before", "Decision rule, with U as guard band", "One edge failed: front_left to rear",
        "Repeat the session for front_left and rear", "sigma mm (limit)", "Signature"})
    EXPECT_THAT(page, HasSubstr(part));
  EXPECT_THAT(page, HasSubstr("sha256 " + Sha256Of("document").str()));
  EXPECT_EQ(page, CertificateOf(CertificateSample()));
}

TEST(CertificatePage, FiguresStandBelowEachOtherAndWordsAcross) {
  const std::string page = CertificateOf(CertificateSample());
  EXPECT_EQ(PoseRowOf(page, "front_right"),
            "<th scope=\"row\"><span class=\"name\">front_right</span></th><td>83.18</td><td>0.40</td><td>-1.20</td>"
            "<td>0.000</td><td>0.000</td><td>0.498</td><td>0.28 (1.0)</td><td>0.032 (0.29)</td><td>2.23 (10)</td>"
            "<td>0.62</td><td>0.071</td><td class=\"text\" colspan=\"1\">yes</td>");
  EXPECT_THAT(PoseRowOf(page, "front_left"), HasSubstr("<td class=\"text\" colspan=\"6\">reference: fixed"));
  EXPECT_THAT(PoseRowOf(page, "tracker"), HasSubstr("<td class=\"text\" colspan=\"12\">unknown: "));
}

TEST(CertificatePage, BeginsWithTheDriveRule) {
  ReportInput input = CertificateSample();
  input.max_age_ns = 10LL * 86'400'000'000'000;
  const std::string page = CertificateOf(input);
  EXPECT_THAT(
      page,
      HasSubstr("OK to drive; repeat the session for front_left and rear, and connect tracker, by 9 Feb 2026.</p>"));
  EXPECT_LT(page.find("OK to drive"), page.find("class=\"word then\""));
}

TEST(CertificatePage, OfManySensorsNoneIsLeftOut) {
  ReportInput input = CertificateSample();
  for (int i = 0; i < 40; ++i)
    AddPose(input.revision, "extra-" + std::to_string(i), true, SamplePose(1, 2, 3, 0.5), 0.0001 * (i + 1));
  const std::string page = CertificateOf(input);
  for (int i = 0; i < 40; ++i) EXPECT_NE(PoseRowOf(page, "extra-" + std::to_string(i)), "") << i;
  EXPECT_NE(PoseRowOf(page, "tracker"), "");
}

// A sheet with a place for a signature reads as a permit.
TEST(CertificatePage, WhatIsNoCertificateHasNoPlaceToSign) {
  ReportInput input = CertificateSample();
  EXPECT_THAT(CertificateOf(input), HasSubstr("class=\"signature\""));
  input.approval = Approval{RevisionState::kCandidate};
  EXPECT_THAT(CertificateOf(input), AllOf(HasSubstr("<h1>Calibration record, no certificate <"),
                                          Not(HasSubstr("class=\"signature\"")), HasSubstr("Not approved")));
  input = CertificateSample();
  input.revision.verdict.level = VerdictLevel::kFail;
  EXPECT_THAT(CertificateOf(input), AllOf(HasSubstr("<h1>Calibration record, no certificate <"),
                                          Not(HasSubstr("class=\"signature\"")), HasSubstr("Do not drive")));
}

// The report and its certificate say one thing.
TEST(CertificatePage, TheReportOfACandidateSaysSoToo) {
  ReportInput input = CertificateSample();
  input.approval = Approval{RevisionState::kCandidate};
  EXPECT_THAT(RenderRevision(input, "{}").value().at("index.html"),
              AllOf(HasSubstr("Not approved: do not rely on it"), Not(HasSubstr("OK to drive"))));
  input.approval.reset();
  EXPECT_THAT(RenderRevision(input, "{}").value().at("index.html"), HasSubstr("OK to drive"));
}

TEST(CertificatePage, NothingOddBecomesANumber) {
  ReportInput input = CertificateSample();
  input.revision.solution.poses[1].covariance(0, 0) = NAN;
  input.revision.solution.poses[2].covariance.setZero();
  const std::string page = CertificateOf(input);
  EXPECT_THAT(PoseRowOf(page, "front_right"), HasSubstr("not known"));
  EXPECT_THAT(PoseRowOf(page, "lidar"), HasSubstr("not known"));
  EXPECT_THAT(page, Not(HasSubstr(">nan")));
}

TEST(CertificatePage, FromElsewhereItFindsItsStyleAndScripts) {
  const ReportInput input = CertificateSample();
  const std::string page = RenderCertificate(input, StandingWhenDrawn(input), "../../../../").value();
  EXPECT_THAT(page, AllOf(HasSubstr("href=\"../../../../style.css\""), HasSubstr("src=\"../../../../assets/tables-")));
}

TEST(CertificatePage, IsBesideTheReportAndLinked) {
  const auto files = RenderRevision(CertificateSample(), "{}").value();
  ASSERT_TRUE(files.contains(kCertificateFile));
  EXPECT_EQ(files.at(kCertificateFile), CertificateOf(CertificateSample()));
  EXPECT_THAT(files.at("index.html"), HasSubstr("href=\"certificate.html\""));
  RobotInput robot;
  robot.row.robot = RobotId("mapper-01");
  robot.row.revision = 7;
  EXPECT_THAT(RenderRobot(robot, Stamp{1}).value(), HasSubstr("href=\"revisions/7/certificate.html\""));
  robot.row.verdict.level = VerdictLevel::kFail;
  robot.row.site = "hall <3>";
  EXPECT_THAT(RenderRobot(robot, Stamp{1}).value(),
              AllOf(HasSubstr(">Record to print</a>"), HasSubstr(", at <bdi>hall &lt;3&gt;</bdi>")));
}

}  // namespace
}  // namespace rigcal::report
