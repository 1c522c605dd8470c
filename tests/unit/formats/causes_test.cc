// The causes of failed pairs in a revision's document.
#include <nlohmann/json.hpp>

#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;
using samples::SampleRevision;

RevisionInput WithCauses() {
  RevisionInput input = SampleRevision();
  Cause size, more;
  size.kind = "board_size";
  size.key = "board_size panel larger";
  size.sensors = {SensorId("left")};
  size.boards = {TargetId("panel"), TargetId("wall")};
  size.captures = {CaptureId("07")};
  size.edges = {input.edges[0].id};
  size.why = "The squares are \"larger\".";
  size.what_to_do = "Measure one.";
  size.command = "rigcal push FOLDER";
  more.kind = more.key = "of_a_later_version";
  input.causes = {size, more};
  return input;
}

TEST(RevisionCauses, ComeBackInBothFormats) {
  const RevisionInput input = WithCauses();
  for (const std::string& text : {WriteRevisionDocument(input), WriteWholeRevisionDocument(input)}) {
    const auto read = ReadRevisionDocument(text);
    ASSERT_TRUE(read) << Sentence(read.error());
    ASSERT_EQ(read->causes.size(), 2u);
    const Cause &cause = read->causes[0], &given = input.causes[0];
    EXPECT_EQ(cause.kind, given.kind);
    EXPECT_EQ(cause.key, given.key);
    EXPECT_EQ(cause.sensors, given.sensors);
    EXPECT_EQ(cause.boards, given.boards);
    EXPECT_EQ(cause.captures, given.captures);
    EXPECT_EQ(cause.edges, given.edges);
    EXPECT_EQ(cause.why, given.why);
    EXPECT_EQ(cause.what_to_do, given.what_to_do);
    EXPECT_EQ(cause.command, given.command);
    EXPECT_EQ(read->causes[1].kind, "of_a_later_version");
    EXPECT_EQ(read->causes[1].command, "");
  }
}

TEST(RevisionCauses, AreAListOfTheDocument) {
  const json causes = json::parse(WriteRevisionDocument(WithCauses()))["causes"];
  ASSERT_EQ(causes.size(), 2u);
  EXPECT_EQ(causes[0]["edges"], json::array({std::string(64, '0')}));
  EXPECT_EQ(causes[0]["command"], "rigcal push FOLDER");
  EXPECT_TRUE(causes[1]["command"].is_null());
  EXPECT_TRUE(causes[1]["edges"].empty());
}

// As those of before, which are read all the same.
TEST(RevisionCauses, ADocumentWithoutAnyHasNoList) {
  const std::string text = WriteRevisionDocument(SampleRevision());
  EXPECT_FALSE(json::parse(text).contains("causes"));
  const auto read = ReadRevisionDocument(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_TRUE(read->causes.empty());
}

TEST(RevisionCauses, ErrorsNameThePath) {
  json document = json::parse(WriteRevisionDocument(WithCauses()));
  document["causes"][1].erase("why");
  const auto read = ReadRevisionDocument(document.dump());
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().what.find("causes[1]"), std::string::npos) << read.error().what;
}

// It names many boards.
TEST(RevisionCauses, ASentenceMayBeLong) {
  RevisionInput input = WithCauses();
  input.causes[0].why.assign(20'000, 'x');
  const auto read = ReadRevisionDocument(WriteRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->causes[0].why, input.causes[0].why);
}

}  // namespace
}  // namespace rigcal::formats
