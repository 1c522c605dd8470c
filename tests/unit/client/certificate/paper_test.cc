// A certificate on pages of A4: nothing is lost, whatever has no room goes on.
#include "client/certificate/paper.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "client/certificate/table_lines.h"
#include "client/print/pdf.h"
#include "client/text/table.h"
#include "server/base/files/durable_file.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kLongText =
    "A sentence of the usual length that the newest session's figures are told by, and so on.";

std::vector<CertificateCell> PoseRow(const std::string& name) {
  std::vector<CertificateCell> row = {{name}};
  for (const char* figure : {"1234.56", "-1234.56", "-1234.56", "-179.123", "-89.123", "179.123", "0.28 (5.0)",
                             "0.032 (0.29)", "2.23 (10)", "0.62", "0.071", "not decided"})
    row.push_back({figure});
  return row;
}

// Of so many sensors, each of which was found, too.
Certificate Of(int sensors, const std::string& name = "front_camera_") {
  Certificate certificate;
  certificate.robot = RobotId("rig"), certificate.revision = 4, certificate.rig_model = "mapper";
  certificate.title = "Calibration certificate", certificate.to_sign = true;
  certificate.measured = "Measured 2026-11-03 12:00:00 UTC, solved 2026-11-03 13:00:00 UTC.";
  certificate.state = "In use: approved by Ada, 4 Nov 2026: checked.";
  certificate.rule = "OK to drive until 1 Feb 2027.";
  certificate.verdict = {VerdictLevel::kWarn, kLongText + " " + kLongText, kLongText, ""};
  CertificatePart poses{"Sensors in the frame of left"}, found{"As found, as left", {kLongText}};
  poses.table.columns = {{"Sensor"}};
  for (const char* title : {"x mm", "y mm", "z mm", "roll deg", "pitch deg", "yaw deg", "sigma mm (limit)",
                            "sigma deg (limit)", "k (dof)", "U mm", "U deg"})
    poses.table.columns.push_back({title, true});
  poses.table.columns.push_back({"within limits"});
  found.table.columns = {{"Sensor"}, {"found"}, {"off by mm (limit)", true}};
  for (int i = 0; i < sensors; ++i) {
    poses.table.rows.push_back(PoseRow(name + std::to_string(i)));
    found.table.rows.push_back({{name + std::to_string(i)}, {"unchanged"}, {"1.50 \xC2\xB1 0.80 (5.0)"}});
  }
  poses.notes = {kLongText + " " + kLongText + " " + kLongText, kLongText + " " + kLongText};
  found.notes = poses.notes;
  CertificatePart with{"Measured with"};
  for (int i = 0; i < 6; ++i) with.text.push_back("Session " + kLongText + " " + kLongText);
  with.text.push_back("Document: revision.json, sha256 " + std::string(64, 'a') + ".");
  certificate.parts = {poses, found, with};
  return certificate;
}

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string TextOf(const print::Sheet& sheet) {
  std::string text;
  for (const print::Label& label : sheet.labels) text += label.text + "\n";
  return text;
}

TEST(CertificatePaper, OfTwelveSensorsItIsOnePage) {
  const std::vector<print::Sheet> sheets = OnPaper(Of(12));
  ASSERT_EQ(sheets.size(), 1u);
  const std::string text = TextOf(sheets[0]);
  for (const char* part :
       {"Calibration certificate\n", "rig, rig model mapper, revision 4", "approved by Ada",
        "OK to drive until 1 Feb 2027.", "Verdict warn: ", "What to do: ", "Signature", "page 1 of 1", "sha256 aaaa"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(CertificatePaper, OfFortySensorsItGoesOnWithItsHeadingAndTitles) {
  const std::vector<print::Sheet> sheets = OnPaper(Of(40));
  ASSERT_EQ(sheets.size(), 2u);
  std::string all;
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const std::string text = TextOf(sheets[i]);
    EXPECT_THAT(text, HasSubstr("revision 4, page " + std::to_string(i + 1) + " of 2"));
    all += text;
  }
  for (int i = 0; i < 40; ++i)
    EXPECT_EQ(CountOf(all, "front_camera_" + std::to_string(i) + " "), 2) << "once as a pose, once as found: " << i;
  EXPECT_EQ(CountOf(all, "As found, as left (continued)\n"), 1);
  EXPECT_EQ(CountOf(all, "off by mm"), 2) << "the titles stand above the rows of each page";
  EXPECT_EQ(CountOf(TextOf(sheets[0]), "Signature"), 0);
  EXPECT_EQ(CountOf(TextOf(sheets[1]), "Signature"), 1);
}

TEST(CertificatePaper, NothingIsBesideThePageNorUponTheFoot) {
  for (const int sensors : {1, 12, 40, 200}) {
    for (const print::Sheet& sheet : OnPaper(Of(sensors, "a-sensor-whose-name-is-as-long-as-names-may-be-at-all-"))) {
      for (std::size_t i = 0; i < sheet.labels.size(); ++i) {
        const print::Label& label = sheet.labels[i];
        EXPECT_LT(label.y_m, i + 1 < sheet.labels.size() ? 0.276 : 0.284) << label.text;
        const double ratio = label.is_monospace ? 0.61 : 0.54;
        if (label.height_m >= 0.003) continue;
        EXPECT_LT(label.x_m + ratio * label.height_m * static_cast<double>(WidthOf(label.text)), 0.2) << label.text;
      }
    }
  }
}

TEST(CertificatePaper, WhatIsNoCertificateHasNoPlaceToSign) {
  Certificate certificate = Of(2);
  certificate.to_sign = false, certificate.title = "Calibration record, no certificate";
  const std::string text = TextOf(OnPaper(certificate)[0]);
  EXPECT_THAT(text, Not(HasSubstr("Signature")));
  EXPECT_EQ(CountOf(text, "Calibration record, no certificate"), 2) << "at the head and at the foot";
}

// The text as another program reads it from the file.
TEST(CertificatePaper, PdfHasThePagesAndTheirText) {
  const TempFolder folder;
  const auto pdf = folder.path() / "certificate.pdf", text = folder.path() / "certificate.txt";
  const auto bytes = print::WritePdf(OnPaper(Of(40)), "certificate");
  ASSERT_TRUE(bytes);
  EXPECT_EQ(*bytes, print::WritePdf(OnPaper(Of(40)), "certificate").value());
  ASSERT_TRUE(WriteDurably(pdf, *bytes));
  if (std::system(("pdftotext -layout " + pdf.string() + " " + text.string() + " 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "pdftotext (Debian: poppler-utils) is not installed";
  const std::string read = ReadFile(text, 1u << 20).value();
  EXPECT_EQ(CountOf(read, "\f"), 2);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(CountOf(read, "front_camera_" + std::to_string(i) + " "), 2) << i;
  EXPECT_THAT(read, HasSubstr("1.50 \xC2\xB1 0.80 (5.0)"));
  EXPECT_THAT(read, HasSubstr("page 2 of 2"));
}

TEST(CertificateTableLines, FiguresAreRightAlignedAndWordsGoOnBelow) {
  CertificateTable table{{{"Sensor"}, {"x mm", true}, {"within limits"}}, {}};
  table.rows = {{{"left"}, {"1.5"}, {"yes"}},
                {{"right"}, {"-12.5"}, {"not decided"}},
                {{"top"}, {"unknown: no edge names it", 2}}};
  const TableLines lines = LinesOf(table);
  EXPECT_THAT(lines.title, ElementsAre("Sensor  x mm within", "             limits"));
  EXPECT_THAT(lines.rows, ElementsAre(ElementsAre("left     1.5 yes"), ElementsAre("right  -12.5 not decided"),
                                      ElementsAre("top    unknown: no edge", "       names it")));
}

TEST(CertificateTableLines, NothingOfALongNameIsLost) {
  CertificateTable table{{{"Sensor"}, {"k", true}}, {{{std::string(30, 'a') + std::string(20, 'b')}, {"2.23"}}}};
  EXPECT_THAT(LinesOf(table).rows[0],
              ElementsAre(std::string(24, 'a') + " 2.23", "aaaaaa" + std::string(18, 'b'), "bb"));
}

TEST(CertificateTableLines, ControlCharactersDoNotReachThePaper) {
  EXPECT_THAT(Wrapped("a\nb\x1b[2J", 20), ElementsAre("a b [2J"));
  EXPECT_THAT(Wrapped("", 20), ElementsAre(""));
  EXPECT_THAT(Wrapped("\xC2\xB1\xC2\xB1\xC2\xB1", 2), ElementsAre("\xC2\xB1\xC2\xB1", "\xC2\xB1"))
      << "whole characters";
}

}  // namespace
}  // namespace rigcal::client
