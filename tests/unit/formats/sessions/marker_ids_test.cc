// Boards whose markers do not count from 0, and plates that are not centred on their pattern, in session.yaml and in
// the manifest.
#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "server/formats/sessions/session_folder.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kTags =
    "{type: aruco_grid, tags: [3, 2], tag_size_m: 0.03, spacing_ratio: 0.3, dictionary: DICT_4X4_50";
const std::string kCharuco =
    "{type: charuco, squares: [3, 4], square_size_m: 0.04, marker_size_m: 0.03, dictionary: DICT_4X4_50";
const std::string kSquares = "{type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025";

Result<SessionHeader> HeaderOf(const std::string& board) {
  return ReadSessionYaml(
      "format: 1\nrobot: r\ncaptured_at: 2026-01-31\ntargets:\n  b: " + board + "}\nsensors:\n  left: {type: camera}\n",
      "session.yaml");
}

std::string RefusalOf(const std::string& board) {
  const auto header = HeaderOf(board);
  return header ? std::string() : header.error().what;
}

std::vector<int> IdsOf(const std::string& board) { return HeaderOf(board).value().targets.at(0).marker_ids; }

std::string ManifestOf(const std::string& board) {
  Manifest manifest = samples::SampleManifest();
  const TargetId id = manifest.header.targets.at(0).id;
  manifest.header.targets.at(0) = HeaderOf(board).value().targets.at(0);
  manifest.header.targets.at(0).id = id;
  return WriteManifest(manifest);
}

TEST(MarkerIds, AreAllNamedOrCountedFromTheFirst) {
  EXPECT_THAT(IdsOf(kTags), IsEmpty());
  EXPECT_THAT(IdsOf(kTags + ", first_id: 0"), IsEmpty()) << "what every board has";
  EXPECT_THAT(IdsOf(kTags + ", ids: [0, 1, 2, 3, 4, 5]"), IsEmpty());
  EXPECT_THAT(IdsOf(kTags + ", first_id: 12"), ElementsAre(12, 13, 14, 15, 16, 17));
  EXPECT_THAT(IdsOf(kTags + ", ids: [7, 3, 40, 1, 0, 2]"), ElementsAre(7, 3, 40, 1, 0, 2));
  EXPECT_THAT(IdsOf(kCharuco + ", first_id: 30"), ElementsAre(30, 31, 32, 33, 34, 35));
}

TEST(SingleTag, HasNoGapsToTell) {
  const std::string tag = "{type: april_grid, tags: [1, 1], tag_size_m: 0.2, first_id: 7";
  const auto header = HeaderOf(tag);
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_THAT(header->targets.at(0).marker_ids, ElementsAre(7));
  EXPECT_GT(header->targets.at(0).spacing_ratio, 0);
  EXPECT_THAT(RefusalOf("{type: april_grid, tags: [2, 1], tag_size_m: 0.2"), HasSubstr("\"spacing_ratio\" is missing"));
}

TEST(MarkerIds, AreRefusedByLineAndField) {
  EXPECT_THAT(RefusalOf(kTags + ", ids: [7, 3, 40]"), HasSubstr("line 5: target b: 3 ids are given for 6 markers"));
  EXPECT_THAT(RefusalOf(kTags + ", ids: [7, 3, 40, 1, 7, 2]"), HasSubstr("marker id 7 is given twice"));
  EXPECT_THAT(RefusalOf(kTags + ", ids: [7, 3, 40, 1, -1, 2]"), HasSubstr("session.yaml line 5"));
  EXPECT_THAT(RefusalOf(kTags + ", first_id: 45"), HasSubstr("marker id 50 is not in DICT_4X4_50"));
  EXPECT_THAT(RefusalOf(kTags + ", first_id: 2, ids: [7, 3, 40, 1, 0, 2]"), HasSubstr("is given beside ids"));
  EXPECT_THAT(RefusalOf(kSquares + ", first_id: 2"), HasSubstr("unknown key \"first_id\""));
}

TEST(MarkerIds, ComeBackFromTheManifestWhichAnOlderServerRefuses) {
  const std::string text = ManifestOf(kTags + ", ids: [7, 3, 40, 1, 0, 2]");
  EXPECT_THAT(text, HasSubstr("\"format\":4"));
  EXPECT_THAT(text, HasSubstr(",\"ids\":[7,3,40,1,0,2],"));
  const auto read = ReadManifest(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_THAT(read->header.targets.at(0).marker_ids, ElementsAre(7, 3, 40, 1, 0, 2));
  EXPECT_EQ(WriteManifest(*read), text);
  EXPECT_THAT(ManifestOf(kTags + ", first_id: 0"), HasSubstr("\"format\":1")) << "every board's own bytes stay";
}

std::string TwoBoards(const std::string& first, const std::string& second, const std::string& camera) {
  const auto header = ReadSessionYaml("format: 1\nrobot: r\ncaptured_at: 2026-01-31\ntargets:\n  north: " + first +
                                          "}\n  south: " + second + "}\nsensors:\n  left: " + camera + "\n",
                                      "session.yaml");
  return header ? std::string() : Sentence(header.error());
}

// A picture of one would be taken for one of the other, and the two boards for one.
TEST(BoardsThatLookAlike, AreRefusedWhereACameraMaySeeBoth) {
  const std::string any = "{type: camera}", turned = "{type: checkerboard, inner_corners: [6, 9], square_size_m: 0.08";
  EXPECT_THAT(
      TwoBoards(kSquares, turned, any),
      HasSubstr("session.yaml line 4: camera left may see targets \"north\" and \"south\", which look alike in a "
                "picture. Say which of them the camera looks at: 'sees: north'"));
  EXPECT_THAT(TwoBoards(kTags, kTags, any), HasSubstr("Print one of them with other ids (first_id)"));
  EXPECT_EQ(TwoBoards(kTags, kTags, "{type: camera, sees: south}"), "");
  EXPECT_EQ(TwoBoards(kTags, kTags + ", first_id: 6", any), "");
  const std::string larger_dictionary = "{type: aruco_grid, tags: [1, 1], tag_size_m: 0.5, dictionary: DICT_4X4_100";
  EXPECT_THAT(TwoBoards(kTags, kTags + ", first_id: 5", any), HasSubstr("look alike")) << "they share id 5";
  EXPECT_THAT(TwoBoards(kTags, larger_dictionary, any), HasSubstr("look alike")) << "the smaller begins the larger";
  EXPECT_THAT(TwoBoards(kTags, kCharuco, any), HasSubstr("look alike"));
  EXPECT_EQ(TwoBoards(kTags, larger_dictionary + ", first_id: 60", any), "");
  EXPECT_EQ(TwoBoards(kSquares, kTags, any), "");
  EXPECT_EQ(TwoBoards(kSquares, "{type: checkerboard, inner_corners: [8, 6], square_size_m: 0.025", any), "");
}

TEST(PlateOffset, ComesBackFromTheManifestWhichAnOlderServerRefuses) {
  const std::string board = kSquares + ", plate_size_m: [0.5, 0.3], plate_offset_m: [0.1, -0.02]";
  const Target target = HeaderOf(board).value().targets.at(0);
  EXPECT_EQ(target.plate_offset_m, Eigen::Vector2d(0.1, -0.02));
  EXPECT_LT((PlateCentreOf(target) - CentreOf(target) - Eigen::Vector3d(0.1, -0.02, 0)).norm(), 1e-15);
  const std::string text = ManifestOf(board);
  EXPECT_THAT(text, HasSubstr("\"format\":4"));
  EXPECT_THAT(text, HasSubstr(",\"plate_offset_m\":[0.1,-0.02],\"plate_size_m\":[0.5,0.3],"));
  const auto read = ReadManifest(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->header.targets.at(0).plate_offset_m, target.plate_offset_m);
  EXPECT_EQ(WriteManifest(*read), text);
}

TEST(PlateOffset, LeavesThePatternOnThePlate) {
  EXPECT_THAT(RefusalOf(kSquares + ", plate_offset_m: [0.1, 0]"), HasSubstr("given without plate_size_m"));
  EXPECT_THAT(RefusalOf(kSquares + ", plate_size_m: [0.5, 0.3], plate_offset_m: [0.2, 0]"),
              HasSubstr("plate_offset_m 0.200000 would leave its pattern beyond the plate's edge"));
  EXPECT_EQ(RefusalOf(kSquares + ", plate_size_m: [0.5, 0.3], plate_offset_m: [0.12, 0.06]"), "");
}

}  // namespace
}  // namespace rigcal::formats
