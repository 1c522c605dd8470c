// A recorded robot cell (robot_cal_tools): a ChArUco board on the wrist before a camera that stands still. Skipped
// where the recording is absent.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/calib/eye_to_hand/eye_to_hand.h"
#include "server/detect/board.h"
#include "server/formats/sessions/poses.h"
#include "server/formats/sessions/session_folder.h"
#include "tests/unit/recordings.h"
#include "tests/unit/temp_folder.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

calib::HandEyeProblem ProblemOf(const fs::path& folder, const Manifest& manifest) {
  calib::HandEyeProblem problem;
  problem.method = Method::kEyeToHand;
  problem.a.sensor = *SensorOf(manifest.header, SensorId("arm"));
  problem.b.sensor = *SensorOf(manifest.header, SensorId("camera"));
  problem.b.board = manifest.header.targets.front();
  for (const Payload& payload : manifest.payloads) {
    const std::string bytes = BytesOf(folder / payload.path);
    if (payload.sensor == problem.a.sensor.id)
      problem.a.poses = formats::ReadPoses(bytes, SensorKind::kTracker, payload.path).value();
    else
      problem.b.views.emplace_back(payload.capture,
                                   detect::Detect(std::as_bytes(std::span(bytes)), *problem.b.board).view);
  }
  return problem;
}

TEST(EyeToHandReal, TheCameraIsWhereOthersHaveIt) {
  RIGCAL_SKIP_WITHOUT_RECORDING("handeye_robot_cal_tools");
  const fs::path source = Recording("handeye_robot_cal_tools") / "test_set_charuco";
  const TempFolder place;
  const fs::path& folder = place.path();
  const std::string extract = RIGCAL_PYTHON " " RIGCAL_SOURCE_DIR "/tests/data/extract_robot_cal_tools.py ";
  ASSERT_EQ(std::system((extract + source.string() + " " + folder.string()).c_str()), 0);
  const auto manifest = formats::ReadSessionFolder(folder, {});
  ASSERT_TRUE(manifest) << Sentence(manifest.error());
  const Edge edge = calib::EstimateEyeToHandEdge(ProblemOf(folder, *manifest));
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
  EXPECT_EQ(edge.uncertainty.rank, 6);
  EXPECT_EQ(edge.figures.at("captures_used"), 16);
  const Se3 check{{-0.0186, 1.2687, 0.2858}, Eigen::Quaterniond(0.02467, 0.04886, 0.55710, -0.82864).normalized()};
  EXPECT_LT((edge.T_a_b.p_m - check.p_m).norm(), 0.010);
  EXPECT_LT(edge.T_a_b.q.angularDistance(check.q) * 180 / M_PI, 0.5);
}

}  // namespace
}  // namespace rigcal
