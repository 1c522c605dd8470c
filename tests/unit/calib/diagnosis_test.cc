#include <gmock/gmock.h>

#include "server/calib/camera/lens_choice.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/core/selection.h"
#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

const Diagnosis* Find(const Edge& edge, const std::string& code) {
  for (const Diagnosis& diagnosis : edge.diagnoses)
    if (diagnosis.code == code) return &diagnosis;
  return nullptr;
}

// The sentence names both sensors or one, and says what to do.
void ExpectFailed(const Edge& edge, const std::string& code, const std::string& naming) {
  EXPECT_EQ(edge.state, EdgeState::kFailed);
  const Diagnosis* diagnosis = Find(edge, code);
  ASSERT_NE(diagnosis, nullptr) << (edge.diagnoses.empty() ? "no diagnosis" : edge.diagnoses[0].what);
  EXPECT_THAT(diagnosis->what, HasSubstr(naming));
  EXPECT_FALSE(diagnosis->cure.empty());
}

void ExpectNote(const Edge& edge, const std::string& code, const std::string& naming) {
  EXPECT_EQ(edge.state, EdgeState::kGood);
  const Diagnosis* diagnosis = Find(edge, code);
  ASSERT_NE(diagnosis, nullptr);
  EXPECT_THAT(diagnosis->what, HasSubstr(naming));
  EXPECT_FALSE(diagnosis->cure.empty());
}

StereoProblem Usual(int captures = 10) { return Photographed(VirtualPair(), TiltedBoards(captures), 0.2, 2); }

// Boards that all face camera a squarely, at different places.
std::vector<Se3> FlatBoards(int count, const Eigen::Vector3d& rotation_rad) {
  std::vector<Se3> boards;
  for (int k = 0; k < count; ++k)
    boards.push_back(BoardAt(
        VirtualPair(), {0.05 + 0.05 * std::sin(2.0 * k), 0.04 * std::cos(3.0 * k), 0.45 + 0.02 * k}, rotation_rad));
  return boards;
}

TEST(Diagnosis, NoCapturesAtAll) {
  StereoProblem problem = Usual();
  problem.captures.clear();
  ExpectFailed(EstimateEdge(problem), "too_few_captures", "together in no capture;");
}

TEST(Diagnosis, TooFewCaptures) {
  ExpectFailed(EstimateEdge(Usual(2)), "too_few_captures",
               "front_left and front_right see the board together in only 2");
}

TEST(Diagnosis, FewCapturesIsANote) { ExpectNote(EstimateEdge(Usual(6)), "few_captures", "only 6 captures"); }

TEST(Diagnosis, BoardNotFoundListsTheCaptures) {
  StereoProblem problem = Usual(5);
  for (const std::size_t k : {0U, 2U, 3U}) problem.captures[k].b = NotFoundView();
  const Edge edge = EstimateEdge(problem);
  ExpectFailed(edge, "too_few_captures", "only 2 captures");
  ExpectFailed(edge, "board_not_found",
               "front_right does not show the 9 x 6 target 'board' in 3 captures: 000, 002, 003");
}

TEST(Diagnosis, BoardNotFoundIsANoteOnAGoodEdge) {
  StereoProblem problem = Usual(12);
  problem.captures[7].a = NotFoundView();
  ExpectNote(EstimateEdge(problem), "board_not_found",
             "front_left does not show the 9 x 6 target 'board' in 1 capture: 007");
}

TEST(Diagnosis, APictureThatCannotBeReadIsNotAHiddenBoard) {
  StereoProblem problem = Usual(12);
  problem.captures[7].a = NotFoundView();
  problem.captures[8].a = BoardView{false, "the picture cannot be decoded", TargetId("board"), 0, 0, {}};
  const Edge edge = EstimateEdge(problem);
  ExpectNote(edge, "picture_unreadable", "1 picture of front_left cannot be read and take no part: 008. The first of");
  ExpectNote(edge, "board_not_found", "front_left does not show the 9 x 6 target 'board' in 1 capture: 007");
}

// Where the cause of a failure is looked for over all pairs, sentences do not help.
TEST(Diagnosis, AFailedEdgeCountsWhatItsFilesHold) {
  StereoProblem problem = Usual(6);
  for (const std::size_t k : {0U, 2U}) problem.captures[k].a.reset();
  problem.captures[1].b = NotFoundView();
  for (const std::size_t k : {4U, 5U})
    problem.captures[k].b = BoardView{false, "the picture cannot be decoded", TargetId("board"), 0, 0, {}};
  const Edge edge = EstimateEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  const std::map<std::string, double> expected = {{"captures_total", 6},        {"files_a", 4},
                                                  {"files_with_board_a", 4},    {"files_b", 6},
                                                  {"files_with_board_b", 3},    {"files_unreadable_b", 2},
                                                  {"first_unreadable_b_idx", 4}};
  for (const auto& [name, value] : expected) {
    ASSERT_TRUE(edge.figures.contains(name)) << name;
    EXPECT_EQ(edge.figures.at(name), value) << name;
  }
  EXPECT_FALSE(edge.figures.contains("files_unreadable_a"));
  EXPECT_EQ(edge.captures.at(4).capture.str(), "004");
}

// Captures that were left out come back into the list, before those of which figures tell the places.
TEST(Diagnosis, TheFirstUnreadableFileStaysTheSameBesideOneAndTheSamePicture) {
  StereoProblem problem = Usual(6);
  for (const std::size_t k : {3U, 4U, 5U})
    problem.captures[k].b = BoardView{false, "the picture cannot be decoded", TargetId("board"), 0, 0, {}};
  problem.captures[5].a = problem.captures[5].b;
  const std::vector<CaptureId> same = {CaptureId("000"), CaptureId("002")};
  DropCaptures(problem, {same.begin(), same.end()});
  Edge edge = EstimateEdge(problem);
  TellSamePictures(same, edge);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  ASSERT_EQ(edge.captures.size(), 6U);
  EXPECT_EQ(edge.figures.at("first_unreadable_b_idx"), 3);
  EXPECT_EQ(edge.figures.at("first_unreadable_a_idx"), 5);
  EXPECT_EQ(edge.captures.at(3).capture.str(), "003");
}

BoardView LegacyView() {
  BoardView view = NotFoundView();
  view.why_not = "no charuco board in the picture; it looks like the legacy layout: set legacy_layout: true";
  return view;
}

// Whatever else makes the edge fail: the description of the board comes first.
TEST(Diagnosis, TheOtherLayoutIsSaidFirstWhereTheEdgeFails) {
  StereoProblem few = Usual(6);
  for (const std::size_t k : {0U, 2U, 3U, 5U}) few.captures[k].b = LegacyView();
  auto flat = Photographed(VirtualPair(), FlatBoards(10, Eigen::Vector3d::Zero()), 0.2, 2);
  flat.captures[4].b = LegacyView();
  for (const auto& [problem, code, count] :
       {std::tuple{few, "too_few_captures", "In 4 captures of front_right (000, 002, 003, 005)"},
        {flat, "no_tilt", "In 1 capture of front_right (004)"}}) {
    const Edge edge = EstimateEdge(problem);
    ExpectFailed(edge, code, "front_left");
    ExpectFailed(edge, "board_layout", count);
    EXPECT_EQ(edge.diagnoses.front().code, "board_layout");
    EXPECT_THAT(edge.diagnoses.front().cure, HasSubstr("Set legacy_layout: true for target 'board'"));
    EXPECT_EQ(Find(edge, "board_not_found"), nullptr) << "nobody has to show the board better";
  }
}

TEST(Diagnosis, TheOtherLayoutIsANoteOnAGoodEdge) {
  StereoProblem problem = Usual(12);
  problem.board.legacy_layout = true;
  problem.captures[7].a = LegacyView();
  ExpectNote(EstimateEdge(problem), "board_layout", "of OpenCV 4.6 and later");
}

// A wide lens under a model that cannot bend so far: more captures would not help.
TEST(Diagnosis, AnotherLensModelIsTheCureWhereItFits) {
  const StereoProblem problem = Photographed(PairOf(CameraModel::kFisheyeKb4), SpreadBoards(14), 0.02, 3);
  CameraProblem camera = CameraOf(problem, &StereoCapture::a);
  const Diagnosis high{"high_residual", "front_left does not fit.", "Take more captures."};
  EXPECT_FALSE(FindBetterLens(camera)) << "its own model fits";
  EXPECT_EQ(WithLensAsCure(high, {{"", camera}}).cure, high.cure);
  camera.camera.camera_model = CameraModel::kPinholeRadtan;
  const auto lens = FindBetterLens(camera);
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->model, CameraModel::kFisheyeKb4);
  EXPECT_LT(lens->rms_px, 0.04);
  const Diagnosis cured = WithLensAsCure(high, {{"_b", camera}});
  EXPECT_THAT(cured.cure, testing::StartsWith("Give front_left 'model: fisheye_kb4'"));
  EXPECT_EQ(cured.figures.at("rms_as_fisheye_kb4_b_px"), lens->rms_px);
  const Diagnosis few{"few_captures", "Only 6 captures.", "Take more captures."};
  EXPECT_EQ(WithLensAsCure(few, {{"", camera}}).cure, few.cure) << "what no lens can cure";
  camera.camera.intrinsics = PairOf(CameraModel::kFisheyeKb4).a;
  EXPECT_FALSE(FindBetterLens(camera)) << "given intrinsics are not doubted here";
}

TEST(Diagnosis, NoCommonView) {
  StereoProblem problem = Usual(8);
  for (std::size_t k = 0; k < 8; ++k) (k % 2 == 0 ? problem.captures[k].a : problem.captures[k].b).reset();
  ExpectFailed(EstimateEdge(problem), "no_common_view", "never in the same capture");
}

TEST(Diagnosis, NoTiltWhereAllBoardsFaceTheCamera) {
  const auto problem = Photographed(VirtualPair(), FlatBoards(10, Eigen::Vector3d::Zero()), 0.2, 2);
  const Edge edge = EstimateEdge(problem);
  ExpectFailed(edge, "no_tilt", "The boards that front_left sees");
  EXPECT_TRUE(edge.figures.contains("board_tilt_a_rad"));
  for (const Diagnosis& diagnosis : edge.diagnoses) EXPECT_TRUE(diagnosis.figures.empty()) << diagnosis.code;
}

TEST(Diagnosis, NoTiltWhereExactBoardsFaceTheCamera) {
  VirtualPair pair;
  pair.a.distortion = pair.b.distortion = {0, 0, 0, 0, 0};
  const auto problem = Photographed(pair, FlatBoards(10, Eigen::Vector3d::Zero()), 0, 0);
  ExpectFailed(EstimateEdge(problem), "no_tilt", "front_left");
}

TEST(Diagnosis, GivenIntrinsicsNeedNoTilt) {
  const VirtualPair pair;
  auto problem = Photographed(pair, FlatBoards(10, Eigen::Vector3d::Zero()), 0.2, 2);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  EXPECT_EQ(EstimateEdge(problem).state, EdgeState::kGood);
}

TEST(Diagnosis, IntrinsicsTakenAsExactIsANote) {
  const VirtualPair pair;
  auto problem = Usual(10);
  problem.camera_b.intrinsics = pair.b;
  ExpectNote(EstimateEdge(problem), "intrinsics_taken_as_exact", "front_right");
}

TEST(Diagnosis, IdenticalCaptures) {
  const VirtualPair pair;
  const Se3 board = TiltedBoards(1)[0];
  ExpectFailed(EstimateEdge(Photographed(pair, {board, board, board, board, board}, 0.1, 2)), "identical_captures",
               "001, 002, 003, 004");
}

TEST(Diagnosis, ARepeatedCaptureIsANoteAndNoBlock) {
  std::vector<Se3> boards = TiltedBoards(10);
  boards.push_back(boards[4]);
  const Edge edge = EstimateEdge(Photographed(VirtualPair(), boards, 0.1, 2));
  ExpectNote(edge, "identical_captures", "010");
  EXPECT_EQ(edge.uncertainty.blocks.size(), 10U);
  EXPECT_FALSE(edge.captures[10].used);
  EXPECT_THAT(edge.captures[10].note, HasSubstr("004"));
}

TEST(Diagnosis, ImageSizeChanged) {
  StereoProblem problem = Usual();
  problem.captures[3].b->image_width_px = 1280;
  ExpectFailed(EstimateEdge(problem), "image_size_changed", "front_right differ in size: those of 003");
}

TEST(Diagnosis, HighResidual) {
  ExpectFailed(EstimateEdge(Photographed(VirtualPair(), TiltedBoards(10), 2.0, 2)), "high_residual", "px rms");
}

TEST(Diagnosis, SwappedPicturesAreNamedAndLeftOut) {
  StereoProblem problem = Usual(12);
  std::swap(problem.captures[3].b, problem.captures[8].b);
  const Edge edge = EstimateEdge(problem);
  ExpectNote(edge, "inconsistent_captures", "003, 008");
  EXPECT_FALSE(edge.captures[3].used);
  EXPECT_LT((edge.T_a_b.p_m - VirtualPair().T_a_b.p_m).norm(), 0.002);
}

// A board so small that its perspective drowns in the noise.
TEST(Diagnosis, AmbiguousPose) {
  VirtualPair pair;
  pair.board.square_m = 0.004;
  std::vector<Se3> boards;
  for (int k = 0; k < 6; ++k)
    boards.push_back(BoardAt(pair, {0.05, 0.02 * k, 1.4}, {0.4 * std::cos(1.1 * k), 0.4 * std::sin(1.1 * k), 0}));
  StereoProblem problem = Photographed(pair, boards, 0.4, 2);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  ExpectFailed(EstimateEdge(problem), "ambiguous_pose", "two poses fit it equally");
}

TEST(Diagnosis, CornersThatAreNoNumbersAreNotUsed) {
  StereoProblem problem = Usual(10);
  problem.captures[2].a->corners_px[7].x() = std::numeric_limits<double>::quiet_NaN();
  const Edge edge = EstimateEdge(problem);
  EXPECT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(edge.uncertainty.Omega.allFinite());
}

TEST(Diagnosis, AllCornersInOnePointFailInWords) {
  StereoProblem problem = Usual(6);
  for (std::size_t k = 0; k < 6; ++k)
    for (auto* view : {&*problem.captures[k].a, &*problem.captures[k].b})
      for (Eigen::Vector2d& uv_px : view->corners_px) uv_px = {100.0 + 20.0 * static_cast<double>(k), 50};
  const Edge edge = EstimateEdge(problem);
  EXPECT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_FALSE(edge.diagnoses.empty());
}

}  // namespace
}  // namespace rigcal::calib
