// Which boards a session's sensors saw, as the report and the certificate tell them.
#include "server/pipeline/boards/seen_boards.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/detect/board.h"
#include "server/pipeline/boards/registry.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/reports/report_input.h"
#include "storage/sessions/detections.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

// Cameras left and right with a picture each, and three boards that differ.
class SeenBoardsTest : public PipelineTest {
 protected:
  void SetUp() override {
    PipelineTest::SetUp();
    manifest_.header.robot = kRig;
    manifest_.header.captured_at = clock_.now;
    manifest_.header.reference = SensorId("left");
    for (const char* name : {"hidden", "shown", "spare"}) {
      Target board;
      board.id = TargetId(name), board.cols = 6 + static_cast<int>(manifest_.header.targets.size()), board.rows = 5;
      board.square_m = 0.025;
      manifest_.header.targets.push_back(board);
    }
    for (const char* name : {"left", "right"}) manifest_.header.sensors.emplace_back().id = SensorId(name);
    AddFile("left/01.png", "left's picture", manifest_);
    AddFile("right/01.png", "right's picture", manifest_);
  }
  void Look(std::size_t picture, std::size_t board, bool found, const std::string& detector = "") {
    const Target& target = manifest_.header.targets[board];
    storage::StoredView stored;
    stored.view.found = found;
    stored.view.target = target.id;
    stored.view.image_width_px = 640, stored.view.image_height_px = 480;
    for (int i = 0; found && i < target.cols * target.rows; ++i) {
      stored.view.corners_px.emplace_back(100 + 20 * (i % target.cols), 100 + 20 * (i / target.cols));
      stored.view.corner_idx.push_back(i);
    }
    ASSERT_TRUE(storage::AppendView(*store_, manifest_.payloads[picture].digest,
                                    detector.empty() ? detect::DetectorKey(target) : detector, stored));
  }
  std::map<TargetId, BoardSeen> Seen() { return LoadBoardsSeen(*store_, manifest_).value(); }
  auto IsSeenAs(BoardSeen hidden, BoardSeen shown, BoardSeen spare) {
    return ElementsAre(Pair(TargetId("hidden"), hidden), Pair(TargetId("shown"), shown),
                       Pair(TargetId("spare"), spare));
  }

  Manifest manifest_;
};

TEST_F(SeenBoardsTest, OnePictureThatShowsItIsEnoughAndNoneMustBeLeftOut) {
  EXPECT_THAT(Seen(), IsSeenAs(BoardSeen::kNotKnown, BoardSeen::kNotKnown, BoardSeen::kNotKnown));
  Look(0, 0, false);
  Look(1, 1, true);
  Look(0, 2, false);
  Look(1, 2, false);
  EXPECT_THAT(Seen(), IsSeenAs(BoardSeen::kNotKnown, BoardSeen::kYes, BoardSeen::kNo));
  Look(1, 0, false, "checkerboard of an earlier version");
  EXPECT_THAT(Seen(), IsSeenAs(BoardSeen::kNo, BoardSeen::kYes, BoardSeen::kNo));
}

TEST_F(SeenBoardsTest, WhoLooksAtAnotherBoardTellsNothing) {
  manifest_.header.sensors[1].sees = TargetId("shown");
  Look(0, 0, false);
  Look(0, 1, false);
  Look(1, 0, true);  // a board that looks alike
  EXPECT_THAT(Seen(), IsSeenAs(BoardSeen::kNo, BoardSeen::kNotKnown, BoardSeen::kNotKnown));
}

TEST_F(SeenBoardsTest, WhichPlateALidarSawBesideATrackerIsNotKnown) {
  for (const std::size_t board : {0, 1, 2})
    for (const std::size_t picture : {0, 1}) Look(picture, board, board == 1);
  Sensor& lidar = manifest_.header.sensors.emplace_back();
  lidar.id = SensorId("top"), lidar.kind = SensorKind::kLidar;
  for (Target& board : manifest_.header.targets) board.plate_m = Eigen::Vector2d(0.3, 0.2);
  EXPECT_THAT(Seen(), IsSeenAs(BoardSeen::kNo, BoardSeen::kYes, BoardSeen::kNo));
  Sensor& tracker = manifest_.header.sensors.emplace_back();
  tracker.id = SensorId("mast"), tracker.kind = SensorKind::kTracker;
  EXPECT_THAT(Seen(), IsSeenAs(BoardSeen::kNotKnown, BoardSeen::kYes, BoardSeen::kNotKnown));
}

// Overdue, of another size, unknown or without a serial: it matters of what was measured with alone.
TEST_F(SeenBoardsTest, OfABoardThatNobodySawOnlyAnotherPatternIsRemarked) {
  for (Target& board : manifest_.header.targets) board.serial = "B-" + board.id.str();
  const auto measure = [&](const char* serial, int cols) {
    const nlohmann::json said = {{"serial", serial}, {"type", "checkerboard"}, {"cols", cols},
                                 {"rows", 5},        {"square_m", "0.025"},    {"measured_x_m", "0.2"},
                                 {"who", "Ada"},     {"measured_y_m", "0.2"},  {"next_check", "2027-02-01"}};
    const auto done = CarryOut(*store_, clock_, "measure_board", said.dump());
    ASSERT_TRUE(done) << Sentence(done.error());
  };
  measure("B-hidden", 6), measure("B-shown", 7), measure("B-spare", 8);
  clock_.now.ns += 60 * 86'400 * std::int64_t{1'000'000'000};
  manifest_.header.captured_at = clock_.now;
  Look(0, 0, false);  // right's file is no picture
  Look(1, 1, true);
  Look(0, 2, false);
  Look(1, 2, false);
  const SessionId id = Close(manifest_);
  const auto codes = [&] {
    std::vector<std::string> told;
    for (const BoardRemark& remark : LoadBoardRemarks(*store_, {id}).value())
      told.push_back(remark.target.str() + " " + remark.code);
    return told;
  };
  EXPECT_THAT(codes(), ElementsAre("hidden check_overdue", "shown check_overdue"));
  StepAll();
  ASSERT_FALSE(revisions_.empty());
  const report::ReportInput input = LoadCertificateInput(*store_, revisions_.back()).value();
  ASSERT_EQ(input.sessions.size(), 1U);
  EXPECT_EQ(input.sessions[0].board_remarks.size(), 2U);
  EXPECT_THAT(input.sessions[0].boards_unseen, ElementsAre(testing::Not(HasSubstr("overdue"))));
  const auto redefined = CarryOut(*store_, clock_, "measure_board",
                                  R"({"serial":"B-spare","type":"charuco","cols":8,"rows":5,"square_m":"0.025",)"
                                  R"("measured_x_m":"0.2","measured_y_m":"0.2","who":"Ada","redefine":true})");
  ASSERT_TRUE(redefined) << Sentence(redefined.error());
  EXPECT_THAT(codes(), ElementsAre("hidden check_overdue", "shown check_overdue", "spare other_pattern"));
}

TEST_F(SeenBoardsTest, ReportsTellThemApart) {
  Look(0, 0, false);  // right's file is no picture
  Look(1, 1, true);
  Look(0, 2, false);
  Look(1, 2, false);
  Close(manifest_);
  StepAll();
  ASSERT_FALSE(revisions_.empty());
  const report::ReportInput input = LoadCertificateInput(*store_, revisions_.back()).value();
  ASSERT_EQ(input.sessions.size(), 1U);
  EXPECT_THAT(input.sessions[0].boards, ElementsAre(HasSubstr("shown: checkerboard 7 x 5, 25 mm")));
  EXPECT_THAT(input.sessions[0].boards_perhaps_seen, ElementsAre(HasSubstr("hidden: ")));
  EXPECT_THAT(input.sessions[0].boards_unseen, ElementsAre(HasSubstr("spare: ")));
}

}  // namespace
}  // namespace rigcal::pipeline
