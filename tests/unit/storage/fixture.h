// A store in a temporary folder, and values to put into it. Every number differs from every other, so that two that are
// exchanged are seen.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "server/base/digests/sha256.h"
#include "server/model/edges/edge.h"
#include "server/model/graph/graph.h"
#include "server/model/sessions/session.h"
#include "storage/edges/edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/detections.h"
#include "storage/sessions/sessions.h"
#include "storage/store.h"
#include "storage/work/jobs.h"
#include "tests/unit/storage/engines.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::storage {

// In memory where there is such a file system, so that tests do not wait for the disk's syncs.
inline std::filesystem::path MemoryFolder() {
  std::error_code code;
  const std::filesystem::path memory = "/dev/shm";
  return std::filesystem::is_directory(memory, code) && access(memory.c_str(), W_OK) == 0
             ? memory
             : std::filesystem::temp_directory_path();
}

struct TempFolder : rigcal::TempFolder {
  TempFolder() : rigcal::TempFolder(MemoryFolder()) {}
};

inline std::string WordsOf(const Error& error) { return NameOf(error.code) + ": " + Sentence(error); }
template <typename T>
std::string WordsOf(const Result<T>& result) {
  return result ? "good" : WordsOf(result.error());
}

inline Digest DigestOf(const std::string& text) { return Sha256Of(text); }

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
inline const RobotId kRobot{"mapper-01"}, kOtherRobot{"mapper-02"};
inline const SensorId kLeft{"left"}, kRight{"right"}, kThird{"third"};

inline Manifest MakeManifest(std::size_t payloads, const RobotId& robot = kRobot) {
  Manifest manifest;
  manifest.header.robot = robot;
  manifest.header.rig_model = "stereo-rig";
  manifest.header.captured_at = {1'700'000'000'000'000'001};
  manifest.header.operator_name = "Ada";
  manifest.header.reference = SensorId("left");
  manifest.header.targets = {{TargetId("board"), 9, 6, 0.025, 0.0001, "B-7"}};
  for (const char* name : {"left", "right"}) manifest.header.sensors.emplace_back().id = SensorId(name);
  for (std::size_t i = 0; i < payloads; ++i) {
    const std::string capture = std::to_string(100'000 + i);
    manifest.payloads.push_back({"left/" + capture + ".png", SensorId("left"), CaptureId(capture),
                                 DigestOf(robot.str() + capture), static_cast<std::int64_t>(1000 + i)});
  }
  return manifest;
}

inline SessionId IdOf(const Manifest& manifest) {
  return SessionId(DigestOf(manifest.header.robot.str() + std::to_string(manifest.payloads.size())).str());
}

// A good edge; all of it derives from `seed`. Rank 5: nothing is known along the z axis.
inline Edge MakeEdge(int seed, const RobotId& robot = kRobot) {
  Edge edge;
  edge.id = EdgeId(DigestOf(robot.str() + " edge " + std::to_string(seed)).str());
  edge.robot = robot;
  edge.frame_a = SensorId("left");
  edge.frame_b = SensorId("s" + std::to_string(seed));
  edge.T_a_b = Se3{{0.1 + seed, -0.02, 1.0 / 3.0}, Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0)};
  Matrix6d root = Matrix6d::Identity();
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < row; ++col) root(row, col) = 0.01 * (6 * row + col) + 1e-3 * seed;
  root.row(2).setZero();
  root.col(2).setZero();
  edge.uncertainty = FromInformation(root * root.transpose() * 1e4, UncertaintySource::kJackknife, 12);
  for (int i = 0; i < 3; ++i) {
    Vector6d d;
    d << 1, 2, 3, 4, 5, 6;
    edge.uncertainty.blocks.push_back({"c" + std::to_string(i), 1e-4 * d * (i + 1) / 7.0});
  }
  Matrix6d covariance = root * root.transpose();
  edge.uncertainty.contributions = {{"board size", covariance * 1e-8}, {"intrinsics", covariance * 3e-8}};
  edge.uncertainty.jackknife_ratio = 0.1 + 0.2;
  edge.method = "stereo";
  edge.epoch = 2;
  edge.state = EdgeState::kGood;
  edge.diagnoses = {{"few", "only 13 captures", "Take more."}, {"tilt", "little tilt", "Tilt it."}};
  edge.figures = {{"captures", 13.0}, {"rms_px", 0.1 + 0.2}};
  edge.captures = {{CaptureId("c0"), 0.21, true, ""}, {CaptureId("c1"), 4.5, false, "an outlier"}};
  edge.evidence = {{"left / c0: 54 corners", SensorId("left"), CaptureId("c0"), DigestOf("picture"), "jpg"}};
  return edge;
}

inline Edge MakeFailedEdge(int seed) {
  Edge edge;
  edge.id = EdgeId(DigestOf("failed " + std::to_string(seed)).str());
  edge.robot = kRobot;
  edge.frame_a = SensorId("left");
  edge.frame_b = SensorId("right");
  edge.method = "stereo";
  edge.diagnoses = {{"too_few_captures", "2 captures show the board in both", "Take 10 more."}};
  return edge;
}

inline Revision MakeRevision(std::int64_t edge_watermark, const RobotId& robot = kRobot) {
  Revision revision;
  revision.robot = robot;
  revision.created_at = {77};
  revision.verdict = {VerdictLevel::kWarn, "sigma of right is 3 mm", "Take more captures."};
  revision.document = "{\"sensors\":[" + std::to_string(edge_watermark) + "]}";
  revision.digest = DigestOf(revision.document);
  revision.edge_watermark = edge_watermark;
  return revision;
}

class StoreTest : public testing::Test {
 protected:
  Store Open() {
    Result<Store> store = Store::Open(place());
    if (!store) throw std::runtime_error(WordsOf(store));
    return std::move(*store);
  }

  [[nodiscard]] StorePlace place() const { return database_.In(folder_.path()); }

  TempFolder folder_;
  TempDatabase database_{folder_.path()};
  Store store_ = Open();
};

// A session of `payloads` payloads, none held.
inline SessionId AppendOpenSession(Store& store, std::size_t payloads, const RobotId& robot = kRobot) {
  const Manifest manifest = MakeManifest(payloads, robot);
  EXPECT_TRUE(AppendSession(store, IdOf(manifest), "{}", manifest, {10}));
  return IdOf(manifest);
}

// One that holds all its payloads and is closed with `pairs`.
inline SessionId AppendClosedSession(Store& store, std::size_t payloads, const std::vector<SensorPair>& pairs,
                                     const RobotId& robot = kRobot) {
  SessionId id = AppendOpenSession(store, payloads, robot);
  std::vector<std::uint32_t> all(payloads);
  for (std::uint32_t i = 0; i < payloads; ++i) all[i] = i;
  EXPECT_TRUE(AppendHeld(store, id, all, {11}));
  EXPECT_TRUE(CloseSession(store, id, pairs, {12}));
  return id;
}

}  // namespace rigcal::storage
