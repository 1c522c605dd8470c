// Serial numbers and firmware of sensors: in session.yaml, in the manifest, and in no byte of a session that tells
// none.
#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "server/formats/sessions/session_folder.h"

namespace rigcal::formats {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string SessionWith(const std::string& of_left) {
  return "format: 1\nrobot: r\ncaptured_at: 2026-01-31\ntargets:\n"
         "  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}\n"
         "sensors:\n  left: {type: camera" +
         of_left + "}\n  right: {type: camera}\n";
}

Manifest ManifestOf(const SessionHeader& header) {
  return {header, {{"left/01.png", SensorId("left"), CaptureId("01"), Digest(std::string(64, 'a')), 10}}};
}

TEST(Parts, AreReadAndKept) {
  const auto header = ReadSessionYaml(SessionWith(", serial: SN 40217, firmware: \"2.30\""), "session.yaml");
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_EQ(header->sensors[0].serial, "SN 40217");
  EXPECT_EQ(header->sensors[0].firmware, "2.30");
  EXPECT_EQ(header->sensors[1].serial, "");
  const std::string text = WriteManifest(ManifestOf(*header));
  EXPECT_THAT(text, HasSubstr(R"("serial":"SN 40217")"));
  const auto back = ReadManifest(text);
  ASSERT_TRUE(back) << Sentence(back.error());
  EXPECT_EQ(back->header.sensors, header->sensors);
  EXPECT_EQ(WriteManifest(*back), text);
}

TEST(Parts, ASessionThatTellsNoneKeepsItsBytes) {
  const auto header = ReadSessionYaml(SessionWith(""), "session.yaml");
  ASSERT_TRUE(header) << Sentence(header.error());
  const std::string text = WriteManifest(ManifestOf(*header));
  EXPECT_THAT(text, Not(HasSubstr("firmware")));
  EXPECT_THAT(text, Not(HasSubstr("serial\":\"S")));
}

TEST(Parts, MoreThanALineIsRefused) {
  const auto lines = ReadSessionYaml(SessionWith(", serial: \"a\\nb\""), "session.yaml");
  ASSERT_FALSE(lines);
  EXPECT_THAT(Sentence(lines.error()), HasSubstr("control characters"));
  EXPECT_FALSE(ReadSessionYaml(SessionWith(", firmware: " + std::string(300, 'x')), "session.yaml"));
  EXPECT_THAT(Sentence(ReadSessionYaml(SessionWith(", seriel: A1"), "session.yaml").error()),
              HasSubstr("did you mean \"serial\"?"));
}

}  // namespace
}  // namespace rigcal::formats
