// A data folder with sessions whose files are there, and what is done to it.
#pragma once

#include <gmock/gmock.h>

#include <fstream>

#include "server/base/files/durable_file.h"
#include "storage/files/blobs.h"
#include "storage/upkeep/backup.h"
#include "storage/upkeep/fsck.h"
#include "storage/upkeep/restore_backup.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {

namespace fs = std::filesystem;

class ClockAt : public Clock {
 public:
  explicit ClockAt(Stamp now) : now_(now) {}
  [[nodiscard]] Stamp Now() const override { return now_; }

 private:
  Stamp now_;
};

inline const SensorPair kUpkeepPair{SensorId("left"), SensorId("right")};

// The content that MakeManifest names as payload `idx`.
inline std::string ContentOf(std::size_t idx, const RobotId& robot = kRobot) {
  return robot.str() + std::to_string(100'000 + idx);
}

// A closed session with its files; its id is that of its manifest, as it is in truth.
inline SessionId Push(Store& store, std::size_t payloads, const RobotId& robot = kRobot) {
  const Manifest manifest = MakeManifest(payloads, robot);
  const std::string text = "{\"robot\":\"" + robot.str() + "\",\"payloads\":" + std::to_string(payloads) + "}";
  SessionId id(DigestOf(text).str());
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < payloads; ++i) {
    all.push_back(i);
    EXPECT_TRUE(AppendBlob(store.BlobFolder(), ContentOf(i, robot)));
  }
  EXPECT_TRUE(AppendSession(store, id, text, manifest, {10}));
  EXPECT_TRUE(AppendHeld(store, id, all, {11}));
  EXPECT_TRUE(CloseSession(store, id, {kUpkeepPair}, {12}));
  return id;
}

// An edge of that session with its picture, and the revision that counts it.
inline EdgeId Calibrate(Store& store, const SessionId& session) {
  Edge edge = MakeEdge(1);
  edge.session = session;
  edge.frame_b = kUpkeepPair.b;
  EXPECT_TRUE(AppendBlob(store.BlobFolder(), "picture"));
  const auto job = LoadNextJob(store, {});
  EXPECT_TRUE(store.Write([&]() -> Status {
    RIGCAL_TRY(AppendEdge(store, edge, {13}));
    return FinishJob(store, (*job)->number, {13});
  }));
  EXPECT_TRUE(AppendRevision(store, MakeRevision(1)));
  return edge.id;
}

inline void FlipByte(const fs::path& file, std::int64_t offset) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(offset);
  const char byte = static_cast<char>(stream.get() ^ 0x10);
  stream.seekp(offset);
  stream.put(byte);
}

class UpkeepTest : public testing::Test {
 protected:
  [[nodiscard]] fs::path data() const { return folder_.path() / "data"; }
  [[nodiscard]] fs::path backup() const { return folder_.path() / "backup"; }
  [[nodiscard]] fs::path restored() const { return folder_.path() / "restored"; }
  [[nodiscard]] fs::path BlobOf(const std::string& content) const {
    return BlobPath(data() / "blobs", DigestOf(content));
  }
  [[nodiscard]] fs::path KeptBlobOf(const std::string& content) const {
    return BlobPath(backup() / "blobs", DigestOf(content));
  }
  Store Open() {
    Result<Store> store = Store::Open(data());
    if (!store) throw std::runtime_error(WordsOf(store));
    return std::move(*store);
  }
  Result<BackupDone> Back(bool verify = false) {
    return MakeBackup({data(), backup(), CopyHow::kCopy, verify}, clock_);
  }
  Result<FsckDone> Check(bool repair = false) { return Fsck({data(), repair}, SystemClock()); }

  TempFolder folder_;
  ClockAt clock_{{1'700'000'000'000'000'000}};
};

// Of one kind; empty where there is none.
inline std::vector<Finding> FoundOf(const FsckDone& done, Finding::Kind kind) {
  std::vector<Finding> found;
  for (const Finding& one : done.findings)
    if (one.kind == kind) found.push_back(one);
  return found;
}

}  // namespace rigcal::storage
