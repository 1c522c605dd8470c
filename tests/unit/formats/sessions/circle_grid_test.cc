// Grids of circles in session.yaml and in the manifest.
#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "server/formats/sessions/session_folder.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using testing::HasSubstr;

std::string Yaml(const std::string& board) {
  return "format: 1\nrobot: r\ncaptured_at: 2026-01-31\ntargets:\n  b: " + board +
         "\nsensors:\n  left: {type: camera}\n";
}

std::string RefusalOf(const std::string& board) {
  const auto header = ReadSessionYaml(Yaml(board), "session.yaml");
  return header ? std::string() : header.error().what;
}

TEST(CircleGridDocuments, ComeBackAsTheyWereWritten) {
  for (const char* kind : {"circle_grid", "asymmetric_circle_grid"}) {
    const auto header = ReadSessionYaml(Yaml("{type: " + std::string(kind) +
                                             ", circles: [4, 11], spacing_m: 0.02, spacing_sigma_m: 0.00004, "
                                             "diameter_m: 0.0141, serial: C-1, plate_size_m: [0.2, 0.26]}"),
                                        "session.yaml");
    ASSERT_TRUE(header) << Sentence(header.error());
    const Target& board = header->targets.at(0);
    EXPECT_EQ(NameOf(board.kind), kind);
    EXPECT_EQ(board.cols, 4);
    EXPECT_EQ(board.rows, 11);
    EXPECT_EQ(board.square_m, 0.02);
    EXPECT_EQ(board.square_sigma_m, 0.00004);
    EXPECT_EQ(board.diameter_m, 0.0141);
    Manifest manifest = samples::SampleManifest();
    const TargetId id = manifest.header.targets.at(0).id;
    manifest.header.targets.at(0) = board;
    manifest.header.targets.at(0).id = id;
    const std::string text = WriteManifest(manifest);
    EXPECT_THAT(text, HasSubstr("{\"circles\":[4,11],\"diameter_m\":0.0141,\"id\":\"" + id.str() + "\""));
    const auto read = ReadManifest(text);
    ASSERT_TRUE(read) << Sentence(read.error());
    EXPECT_EQ(read->header.targets.at(0), manifest.header.targets.at(0));
    EXPECT_EQ(WriteManifest(*read), text);
  }
}

TEST(CircleGridDocuments, OtherBoardsKeepTheirBytes) {
  const std::string text = WriteManifest(samples::SampleManifest());
  EXPECT_EQ(text.find("circles"), std::string::npos);
  EXPECT_EQ(text.find("diameter_m"), std::string::npos);
}

TEST(CircleGridDocuments, AreRefusedByLineAndField) {
  EXPECT_EQ(RefusalOf("{type: circle_grid, circles: [7, 5], spacing_m: 0.03, diameter_m: 0.015}"), "");
  EXPECT_THAT(RefusalOf("{type: circle_grid, circles: [7, 5], spacing_m: 0.03}"),
              HasSubstr("session.yaml line 5: target 'b': \"diameter_m\" is missing"));
  EXPECT_THAT(RefusalOf("{type: circle_grid, circles: [7, 5], square_size_m: 0.03, diameter_m: 0.015}"),
              HasSubstr("unknown key \"square_size_m\""));
  EXPECT_THAT(RefusalOf("{type: circle_grid, circles: [7], spacing_m: 0.03, diameter_m: 0.015}"),
              HasSubstr("circles: must be two numbers, [columns, rows]"));
  EXPECT_THAT(RefusalOf("{type: circle_grid, circles: [7, 5], spacing_m: 0.03, diameter_m: 0.03}"),
              HasSubstr("session.yaml line 5: target b: diameter_m 0.030000 does not fit spacing_m 0.030000"));
  EXPECT_THAT(RefusalOf("{type: asymmetric_circle_grid, circles: [11, 4], spacing_m: 0.02, diameter_m: 0.014}"),
              HasSubstr("with an even number of rows (4) looks the same turned by half"));
  EXPECT_THAT(RefusalOf("{type: circles, circles: [7, 5], spacing_m: 0.03, diameter_m: 0.015}"),
              HasSubstr("type: is not known here"));
}

}  // namespace
}  // namespace rigcal::formats
