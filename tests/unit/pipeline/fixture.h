// A store in a temporary folder, a clock that stands still, and a recorder of what the pipeline announces.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "server/base/digests/sha256.h"
#include "server/formats/documents.h"
#include "server/pipeline/robots/robot_state.h"
#include "server/pipeline/step.h"
#include "storage/edges/edges.h"
#include "storage/files/blobs.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"
#include "tests/unit/recordings.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::pipeline {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
inline const RobotId kRig("r");
inline const std::vector<SensorId> kCameras = {SensorId("left"), SensorId("rear"), SensorId("right")};

class StandingClock : public Clock {
 public:
  Stamp now{1'800'000'000'000'000'000};
  [[nodiscard]] Stamp Now() const override { return now; }
};

class PipelineTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = place_.emplace().path();
    auto opened = storage::Store::Open(folder_);
    ASSERT_TRUE(opened) << Sentence(opened.error());
    store_ = std::make_unique<storage::Store>(std::move(*opened));
    announcer_.event = [this](const RobotId&, const std::string& kind, const std::string&, const std::string& json) {
      events_.push_back({kind, json});
    };
    announcer_.state = [this](const RobotId& robot) {
      states_.push_back(LoadRobotState(*store_, robot).value().value());
      revisions_.push_back(storage::LoadRevision(*store_, robot, states_.back().newest.number).value().value());
      if (const auto document = formats::ReadRevisionDocument(revisions_.back().document))
        poses_ = document->solution.poses;
    };
  }
  void TearDown() override {
    store_.reset();
    place_.reset();
  }

  Result<StepResult> StepOnce() { return Step({*store_, clock_, live_, claims_, announcer_, cameras_}); }
  // Steps until there is nothing to do; the number of steps that worked.
  int StepAll() {
    for (int worked = 0; worked < 1000; ++worked) {
      const auto result = StepOnce();
      if (!result) ADD_FAILURE() << Sentence(result.error());
      if (!result || !result->worked) return worked;
    }
    ADD_FAILURE() << "the pipeline never comes to rest";
    return 1000;
  }
  // The revision that robots were told to use last; 0: none.
  [[nodiscard]] int InUse() const {
    return states_.empty() || !states_.back().calibration ? 0 : states_.back().calibration->revision.number;
  }
  [[nodiscard]] int Count(const std::string& kind) const {
    return static_cast<int>(
        std::count_if(events_.begin(), events_.end(), [&](const auto& e) { return e.first == kind; }));
  }

  // A closed session whose payloads are `files` (path -> bytes), as the recorder would leave it.
  SessionId StoreSession(const std::string& robot, const std::map<std::string, std::string>& files,
                         const std::vector<SensorId>& remounted = {}) {
    Manifest manifest;
    manifest.header.remounted = remounted;
    manifest.header.robot = RobotId(robot);
    manifest.header.reference = SensorId("left");
    manifest.header.captured_at = clock_.now;
    Target board;
    board.id = TargetId("board");
    board.cols = 9;
    board.rows = 6;
    board.square_m = 0.025;
    manifest.header.targets = {board};
    for (const char* name : {"left", "right"}) {
      Sensor sensor;
      sensor.id = SensorId(name);
      sensor.sees = board.id;
      manifest.header.sensors.push_back(sensor);
    }
    for (const auto& [path, bytes] : files) AddFile(path, bytes, manifest);
    return Close(manifest);
  }

  void AddFile(const std::string& path, const std::string& bytes, Manifest& manifest) {
    const std::filesystem::path file(path);
    Payload payload;
    payload.path = path;
    payload.sensor = SensorId(file.parent_path().string());
    payload.capture = CaptureId(file.stem().string());
    payload.digest = *storage::AppendBlob(store_->BlobFolder(), bytes);
    payload.size_bytes = static_cast<std::int64_t>(bytes.size());
    manifest.payloads.push_back(payload);
  }

  SessionId Close(const Manifest& manifest) {
    const std::string json = formats::WriteManifest(manifest);
    const SessionId id(Sha256Of(json).str());
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < manifest.payloads.size(); ++i) all.push_back(i);
    const Status stored = store_->Write([&]() -> Status {
      RIGCAL_TRY(storage::AppendSession(*store_, id, json, manifest, clock_.now));
      RIGCAL_TRY(storage::AppendHeld(*store_, id, all, clock_.now));
      return storage::CloseSession(*store_, id, PairsToCalibrate(manifest.header), clock_.now);
    });
    if (!stored) ADD_FAILURE() << Sentence(stored.error());
    return id;
  }

  void StoreEdges(const std::vector<Edge>& edges) {
    const Status stored = store_->Write([&]() -> Status {
      for (const Edge& edge : edges) {
        RIGCAL_TRY(storage::AppendRobot(*store_, edge.robot, clock_.now));
        RIGCAL_TRY(storage::AppendEdge(*store_, edge, clock_.now));
      }
      return {};
    });
    if (!stored) ADD_FAILURE() << Sentence(stored.error());
  }

  // The real picture pairs as session files; empty where they are absent.
  static std::map<std::string, std::string> RealPictures() {
    std::map<std::string, std::string> files;
    for (const auto& [name, path] : StereoPairs()) {
      std::stringstream bytes;
      bytes << std::ifstream(path, std::ios::binary).rdbuf();
      files[name + ".jpg"] = bytes.str();
    }
    return files;
  }

  std::optional<TempFolder> place_;
  std::filesystem::path folder_;
  std::unique_ptr<storage::Store> store_;
  StandingClock clock_;
  LiveGraphs live_;
  calib::CameraMemory cameras_;
  RobotLocks claims_;
  Announcer announcer_;
  std::vector<std::pair<std::string, std::string>> events_;
  std::vector<Revision> revisions_;
  std::vector<SensorPose> poses_;   // of the newest of them
  std::vector<RobotState> states_;  // as they are told after each revision
};

// A finished edge between two sensors with T_a_b = a shift along x and equal, independent errors.
inline Edge GivenEdge(const std::string& robot, const std::string& a, const std::string& b, double x_m) {
  Edge edge;
  edge.robot = RobotId(robot);
  edge.frame_a = SensorId(a);
  edge.frame_b = SensorId(b);
  edge.T_a_b.p_m.x() = x_m;
  edge.uncertainty = FromInformation(Matrix6d::Identity() * 1e6, UncertaintySource::kGiven, 0);
  edge.method = "given";
  edge.state = EdgeState::kGood;
  return edge;
}

inline std::vector<Edge> Triangle(const std::string& robot) {
  std::vector<Edge> edges = {GivenEdge(robot, "a", "b", 1.0), GivenEdge(robot, "b", "c", 1.0),
                             GivenEdge(robot, "a", "c", 2.003)};
  AssignPushedIds(edges);
  return edges;
}

}  // namespace rigcal::pipeline
