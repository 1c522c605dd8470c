// The document of a certificate: there and back, and what is refused.
#include "server/formats/answers/certificate.h"

#include <gmock/gmock.h>

namespace rigcal::formats {
namespace {

Certificate Sample() {
  Certificate certificate;
  certificate.robot = RobotId("rig"), certificate.revision = 4, certificate.rig_model = "mapper";
  certificate.title = "Calibration certificate", certificate.to_sign = true;
  certificate.measured = "Measured then.", certificate.state = "In use.", certificate.rule = "OK to drive.";
  certificate.verdict = {VerdictLevel::kPass, "All agree.", "", ""};
  CertificatePart poses{"Sensors", {"Above."}, {}, {"Below."}};
  poses.table.columns = {{"Sensor"}, {"x mm", true}, {"U mm", true}};
  poses.table.rows = {{{"left"}, {"1.5"}, {"0.62"}}, {{"right"}, {"unknown: \"why\"", 2}}};
  certificate.parts = {poses, {"Measured with", {"Software."}}};
  return certificate;
}

TEST(CertificateDocument, ReadsBackAsItWasWritten) {
  const std::string text = WriteCertificate(Sample());
  const auto read = ReadCertificate(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(WriteCertificate(*read), text);
  EXPECT_EQ(read->robot.str(), "rig");
  EXPECT_EQ(read->rig_model, "mapper");
  EXPECT_TRUE(read->to_sign);
  EXPECT_EQ(read->parts, Sample().parts);
  Certificate other = Sample();
  other.rig_model.clear(), other.to_sign = false;
  const auto again = ReadCertificate(WriteCertificate(other));
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->rig_model.empty());
  EXPECT_FALSE(again->to_sign);
}

TEST(CertificateDocument, RowsThatDoNotFillTheirTableAreRefused) {
  Certificate certificate = Sample();
  certificate.parts[0].table.rows[1].pop_back();
  const auto read = ReadCertificate(WriteCertificate(certificate));
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().what, testing::HasSubstr("parts[0].table.rows[1]: must fill the columns of the table"));
  EXPECT_FALSE(ReadCertificate("{}"));
}

}  // namespace
}  // namespace rigcal::formats
