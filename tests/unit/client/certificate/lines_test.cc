// A certificate from the server's documents: what it says, what it leaves out, and that it is one page.
#include "client/certificate/lines.h"

#include <gmock/gmock.h>

#include "client/certificate/paper.h"
#include "client/print/pdf.h"

namespace rigcal::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Document Of(const std::string& json) { return Document::Parse(json, "test").value(); }

std::string Sensor(const std::string& id, double sigma_m, const std::string& dof) {
  const std::string s = std::to_string(sigma_m);
  return R"({"id":")" + id +
         R"(","known":true,"T_ref_sensor":{"p_m":[0.1,0.2,0.3],"q_xyzw":[0,0,0,1]},"sigma_m":[0.0001,)" + s +
         R"(,0.0001],"sigma_rad":[0.0001,0.0001,0.0001],"dof":)" + dof +
         R"(,"tolerance_m":0.005,"tolerance_rad":0.005})";
}

// The right sensor was found 4.5 mm off, by 0.4 mm.
std::string Show(const std::string& level, const std::string& sensors) {
  return R"({"robot":"rig","revision":4,"state":"approved","calibrated_at":"2026-11-03T12:00:00Z","created_at":"2026-11-03T13:00:00Z",)"
         R"("digest":"abcd","drive":{"rule":"OK to drive"},"decision":{"how":"approved","who":"Ada","at":"2026-11-04T12:00:00Z","reason":"checked"},)"
         R"("as_found":{"text":"As found: right moved.","why_not":null,"relative_to":"left","sensors":[{"id":"right","state":"drifted",)"
         R"("change":[0.0045,0,0,0.001,0,null],"sigma":[0.0004,0.0004,0.0004,0.0001,0.0001,null],"left":[0.0002,0,0,0,0,null]}]},)"
         R"("document":{"robot":"rig","reference":"left","verdict":{"level":")" +
         level +
         R"(","why":"all agree"},"edges":[{"state":"good","session":"s2"},{"state":"failed","session":"s1"}],"sensors":[{"id":"left","known":true},)" +
         sensors + "]}}";
}

CertificateDocuments Documents(const std::string& level, const std::string& sensors) {
  return {
      Of(Show(level, sensors)),
      "0.2.0",
      {Of(R"({"session":{"session":"s2"},"manifest":{"captured_at":"2026-11-03T12:00:00Z","operator":"Eve","rig_model":"mapper",)"
          R"("conditions":{"site":"hall 3","temperature":"21"},"targets":[{"id":"wall","type":"charuco","inner_corners":[11,8],"square_size_m":0.025,"serial":"B-1"}]},)"
          R"("board_remarks":[{"target":"wall","code":"check_overdue","what":"its check was due"}]})")}};
}

std::string TextOf(const std::vector<CertificateLine>& lines) {
  std::string text;
  for (const CertificateLine& line : lines) text += line.text + "\n";
  return text;
}
std::string TextOf(const std::string& level, const std::string& sensors) {
  return TextOf(CertificateLines(Documents(level, sensors)));
}

std::string RowOf(const std::string& text, const std::string& begin) {
  const auto from = text.find("\n" + begin);
  return from == std::string::npos ? "" : text.substr(from + 1, text.find('\n', from + 1) - from - 1);
}

TEST(CertificateLines, SayWhatWhenByWhomAndWithWhat) {
  const std::string text = TextOf("pass", Sensor("right", 0.0002, "10"));
  for (const char* part :
       {"Calibration certificate\n", "rig, rig model mapper, revision 4", "Measured 2026-11-03T12:00:00Z",
        "approved by Ada, 4 Nov 2026: checked", "OK to drive. Verdict pass: all agree",
        "by Eve; site: hall 3, temperature: 21", "Board wall: charuco 11 x 8, 25.00 mm, serial B-1 (its check was due)",
        "Printed by rigcald 0.2.0", "sha256 abcd", "Signature", "Decision rule, guard band U"})
    EXPECT_THAT(text, HasSubstr(part));
}

// Student's t for 95 % on both sides: 2.228 with 10 degrees of freedom.
TEST(CertificateLines, UIsStudentsAndDecides) {
  EXPECT_THAT(
      RowOf(TextOf("pass", Sensor("right", 0.0002, "10")), "right"),
      ::testing::AllOf(HasSubstr("0.200 (5.00)"), HasSubstr(" 2.23 "), HasSubstr(" 0.446 "), HasSubstr("  yes")));
  EXPECT_THAT(RowOf(TextOf("warn", Sensor("right", 0.003, "10")), "right"), HasSubstr("  not decided"));
  EXPECT_THAT(RowOf(TextOf("warn", Sensor("right", 0.006, "10")), "right"), HasSubstr("  no"));
  EXPECT_THAT(RowOf(TextOf("warn", Sensor("right", 0.0002, "null")), "right"), HasSubstr("  -  "));
}

TEST(CertificateLines, AsFoundIsHeldAgainstTheToleranceWithAGuardBand) {
  const std::string text = TextOf("pass", Sensor("right", 0.0002, "10"));
  EXPECT_THAT(text, HasSubstr("As found: right moved."));
  EXPECT_THAT(RowOf(text, "right   drifted"), ::testing::AllOf(HasSubstr("4.500 +- 0.800"), HasSubstr("0.057 +- 0.011"),
                                                               HasSubstr("not decided"), HasSubstr("0.200")));
  EXPECT_EQ(Decide(0.004, 0.001, 0.005), Decision::kWithin);
  EXPECT_EQ(Decide(0.0041, 0.001, 0.005), Decision::kOpen);
  EXPECT_EQ(Decide(0.0061, 0.001, 0.005), Decision::kBeyond);
}

TEST(CertificateLines, WhatWasNotMeasuredHasNoNumber) {
  std::string show = Show("pass", Sensor("right", 0.0002, "10"));
  for (const std::string part : {"0.001,0,null]", "0.0001,0.0001,null]", "\"left\":[0.0002,0,0,0,0,null]"}) {
    const std::string instead = part.starts_with('"') ? "\"left\":null" : "null,null,null]";
    show.replace(show.find(part), part.size(), instead);
  }
  const std::string row = RowOf(TextOf(CertificateLines({Of(show), "0", {}})), "right   drifted");
  EXPECT_THAT(row, HasSubstr("4.500 +- 0.800"));
  EXPECT_THAT(row, Not(HasSubstr("0.000")));
}

TEST(CertificateLines, TheDriftedAreNotAmongThoseLeftOut) {
  std::string show = Show("pass", Sensor("right", 0.0002, "10"));
  const std::string begin = "\"sensors\":[{\"id\":\"right\"";
  std::string before = "\"sensors\":[";
  for (int i = 0; i < 9; ++i) before += R"({"id":"other)" + std::to_string(i) + R"(","state":"not_measured"},)";
  show.replace(show.find(begin), begin.size(), before + "{\"id\":\"right\"");
  const std::string text = TextOf(CertificateLines({Of(show), "0", {}}));
  EXPECT_NE(RowOf(text, "right   drifted"), "");
  EXPECT_THAT(text, HasSubstr("2 more are in the report."));
}

TEST(CertificateLines, WhatMustNotBeReliedOnIsNoCertificateAndIsNotSigned) {
  for (const char* level : {"fail", "unknown"}) {
    const std::string text = TextOf(level, Sensor("right", 0.0002, "10"));
    EXPECT_THAT(text, HasSubstr("Calibration record, no certificate\n"));
    EXPECT_THAT(text, Not(HasSubstr("Signature")));
  }
  for (const char* state : {"candidate", "rejected", "taken_back"}) {
    std::string show = Show("pass", Sensor("right", 0.0002, "10"));
    show.replace(show.find("approved"), 8, state);
    EXPECT_THAT(TextOf(CertificateLines({Of(show), "0", {}})), Not(HasSubstr("Signature"))) << state;
  }
}

TEST(CertificateLines, OnlySessionsOfEdgesThatCount) {
  EXPECT_THAT(SessionsCounted(Of(Show("pass", Sensor("right", 0.0002, "10")))), ::testing::ElementsAre("s2"));
}

TEST(CertificateLines, OfManySensorsAndSessionsItIsOnePageAndSaysWhatIsLeftOut) {
  std::string sensors;
  for (int i = 0; i < 40; ++i)
    sensors += (i > 0 ? "," : "") + Sensor("a-sensor-with-a-long-name-" + std::to_string(i), 1e-5 * (i + 1), "10");
  CertificateDocuments documents = Documents("pass", sensors);
  while (documents.sessions.size() < 16) documents.sessions.push_back(documents.sessions[0]);
  const std::vector<CertificateLine> lines = CertificateLines(documents);
  const std::string text = TextOf(lines);
  EXPECT_THAT(text, HasSubstr("27 more, all more certain than these"));
  EXPECT_THAT(text, HasSubstr("Older sessions that count, too: 12."));
  EXPECT_NE(RowOf(text, "a-sensor-with-a-long-name-39"), "");
  EXPECT_EQ(RowOf(text, "a-sensor-with-a-long-name-3 "), "");
  const auto sheet = OnPaper(lines);
  ASSERT_TRUE(sheet);
  for (const print::Label& label : sheet->labels) EXPECT_LT(label.y_m, sheet->height_m - 0.016);
  EXPECT_EQ(print::WritePdf(*sheet, "c").value(), print::WritePdf(*OnPaper(lines), "c").value());
}

TEST(CertificateLines, AreNeverCutInSilence) {
  EXPECT_FALSE(OnPaper(std::vector<CertificateLine>(100, {"line", LineStyle::kText})));
}

TEST(CertificateLines, OfAnEmptyDocumentThereIsNothingToRelyOn) {
  EXPECT_THAT(TextOf(CertificateLines({Of("{}"), "0", {}})), HasSubstr("no certificate"));
}

}  // namespace
}  // namespace rigcal::client
