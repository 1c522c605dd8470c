// What the disk has not kept: named, asked for again, and what failed for want of it run again.
#include "storage/files/lost_blobs.h"

#include <gmock/gmock.h>

#include <fstream>

#include "storage/files/blobs.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

const SensorPair kPair{SensorId("left"), SensorId("right")};

class LostBlobsTest : public StoreTest {
 protected:
  void FlipAByte(const Digest& digest) {
    std::fstream file(BlobPath(store_.BlobFolder(), digest), std::ios::in | std::ios::out | std::ios::binary);
    const char old = static_cast<char>(file.get());
    file.seekp(0);
    file.put(static_cast<char>(old ^ 1));
  }
  JobRow FinishedJob() {
    const JobRow job = LoadNextJob(store_, {}).value().value();
    EXPECT_TRUE(FinishJob(store_, job.number, {2}));
    return job;
  }
  Digest DigestAt(std::size_t idx) { return MakeManifest(2).payloads[idx].digest; }
};

TEST_F(LostBlobsTest, AFlippedByteIsNoticedAndSetAsideUnderAFreeName) {
  const fs::path blobs = store_.BlobFolder();
  const Digest digest = AppendBlob(blobs, "picture").value();
  for (const char* aside : {".damaged", ".damaged.2"}) {
    FlipAByte(digest);
    const auto bytes = LoadBlob(blobs, digest, 100);
    ASSERT_FALSE(bytes);
    EXPECT_EQ(bytes.error().code, ErrorCode::kConflict);
    EXPECT_THAT(bytes.error().what, HasSubstr(digest.str()));
    EXPECT_EQ(SetDamagedAside(blobs, digest).value(), BlobState::kDamaged);
    EXPECT_EQ(LookAtBlob(blobs, digest).value(), BlobState::kMissing);
    EXPECT_EQ(fs::file_size(BlobPath(blobs, digest).string() + aside), 7u);
    ASSERT_TRUE(AppendBlob(blobs, "picture"));
    EXPECT_EQ(SetDamagedAside(blobs, digest).value(), BlobState::kGood);
  }
  fs::resize_file(BlobPath(blobs, digest), 3);
  EXPECT_EQ(LookAtBlob(blobs, digest).value(), BlobState::kDamaged);
}

TEST_F(LostBlobsTest, WhatIsLostIsNotHeldUntilItComesAgain) {
  const SessionId session = AppendClosedSession(store_, 2, {kPair});
  const JobRow job = FinishedJob();
  ASSERT_TRUE(AppendLost(store_, DigestAt(1), BlobState::kDamaged, job.number, {3}));
  ASSERT_TRUE(AppendLost(store_, DigestAt(1), BlobState::kMissing, job.number, {4}));  // known already
  EXPECT_THAT(LoadHeld(store_, session).value(), ElementsAre(true, false));
  EXPECT_FALSE(IsHeld(store_, kRobot, DigestAt(1)).value());
  EXPECT_TRUE(IsHeld(store_, kRobot, DigestAt(0)).value());
  const SessionRow row = LoadSession(store_, session).value().value();
  EXPECT_TRUE(row.closed);
  EXPECT_EQ(row.payloads_held, 1);
  const LostPayloads lost = LoadLost(store_, 10).value();
  ASSERT_EQ(lost.count, 1);
  EXPECT_EQ(lost.first[0].robot, kRobot);
  EXPECT_EQ(lost.first[0].session, session);
  EXPECT_EQ(lost.first[0].path, "left/100001.png");
  EXPECT_EQ(lost.first[0].state, BlobState::kDamaged);
  EXPECT_FALSE(LoadNextJob(store_, {}).value());

  ASSERT_TRUE(AppendHeld(store_, session, {1}, {5}));
  EXPECT_THAT(LoadHeld(store_, session).value(), ElementsAre(true, true));
  EXPECT_TRUE(IsHeld(store_, kRobot, DigestAt(1)).value());
  EXPECT_EQ(LoadSession(store_, session).value()->payloads_held, 2);
  EXPECT_EQ(LoadLost(store_, 10).value().count, 0);
  EXPECT_EQ(LoadNextJob(store_, {}).value()->number, job.number);
  ASSERT_TRUE(FinishJob(store_, job.number, {6}));
  EXPECT_FALSE(LoadNextJob(store_, {}).value());
}

TEST_F(LostBlobsTest, AJobWaitsForAllThatItLacks) {
  const SessionId session = AppendClosedSession(store_, 2, {kPair});
  const JobRow job = FinishedJob();
  for (std::size_t i : {0u, 1u}) ASSERT_TRUE(AppendLost(store_, DigestAt(i), BlobState::kMissing, job.number, {3}));
  EXPECT_EQ(LoadLost(store_, 1).value().count, 2);
  EXPECT_EQ(LoadLost(store_, 1).value().first.size(), 1u);
  ASSERT_TRUE(AppendHeld(store_, session, {0}, {5}));
  EXPECT_FALSE(LoadNextJob(store_, {}).value());
  ASSERT_TRUE(AppendHeld(store_, session, {1}, {5}));
  EXPECT_TRUE(LoadNextJob(store_, {}).value());
}

TEST_F(LostBlobsTest, WithoutAJobThatWaitsTheReportIsMadeAnew) {
  const SessionId session = AppendClosedSession(store_, 2, {kPair});
  const RevisionKey key{kRobot, AppendRevision(store_, MakeRevision(1)).value()};
  ASSERT_TRUE(AppendPublication(store_, key, {2}));
  EXPECT_TRUE(LoadUnpublished(store_).value().empty());
  ASSERT_TRUE(AppendLost(store_, DigestAt(0), BlobState::kDamaged, std::nullopt, {3}));
  ASSERT_TRUE(AppendHeld(store_, session, {0}, {5}));
  ASSERT_EQ(LoadUnpublished(store_).value().size(), 1u);
  EXPECT_TRUE(AppendPublication(store_, key, {6}));
  EXPECT_TRUE(LoadUnpublished(store_).value().empty());
}

}  // namespace
}  // namespace rigcal::storage
