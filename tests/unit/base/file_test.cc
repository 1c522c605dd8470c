#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <vector>

#include "server/base/digests/sha256.h"
#include "server/base/files/cached_files.h"
#include "server/base/files/durable_file.h"
#include "server/base/files/file_descriptor.h"
#include "server/base/process/parallel_for.h"
#include "tests/unit/temp_folder.h"

namespace rigcal {
namespace {

class Files : public ::testing::Test {
 protected:
  [[nodiscard]] std::size_t EntryCount() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }
  TempFolder place_;
  const std::filesystem::path folder_ = place_.path();
};

TEST_F(Files, WriteThenReadGivesTheSameBytes) {
  const std::string bytes("a\0b\xff\n", 5);
  ASSERT_TRUE(WriteDurably(folder_ / "file", bytes).has_value());
  EXPECT_EQ(ReadFile(folder_ / "file", 5).value(), bytes);
  EXPECT_EQ(EntryCount(), 1U) << "a temporary file was left";
}

TEST_F(Files, FoldersAreMadeWithThoseAboveThem) {
  EXPECT_TRUE(MakeFolderDurably(folder_ / "visits" / "monday"));
  EXPECT_TRUE(std::filesystem::is_directory(folder_ / "visits" / "monday"));
  EXPECT_TRUE(MakeFolderDurably(folder_ / "visits" / "monday")) << "again";
}

TEST_F(Files, AFileInTheWayOfAFolderIsNamed) {
  ASSERT_TRUE(WriteDurably(folder_ / "visits", "a file"));
  const Status made = MakeFolderDurably(folder_ / "visits" / "monday");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kStorage);
  EXPECT_NE(made.error().what.find((folder_ / "visits").string()), std::string::npos) << made.error().what;
}

// Whether a page of it is in memory. A read that does not wait (RWF_NOWAIT) would ask the disk to read ahead, and now
// and then find the answer come already.
bool IsCached(const std::filesystem::path& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  const std::size_t size_bytes = std::filesystem::file_size(path);
  void* mapped = ::mmap(nullptr, size_bytes, PROT_READ, MAP_SHARED, file.get(), 0);
  if (mapped == MAP_FAILED) return false;
  constexpr std::size_t kPageBytes = 4096;
  std::vector<unsigned char> pages((size_bytes + kPageBytes - 1) / kPageBytes);
  const bool told = ::mincore(mapped, size_bytes, pages.data()) == 0;
  ::munmap(mapped, size_bytes);
  return told && std::any_of(pages.begin(), pages.end(), [](unsigned char page) { return (page & 1) != 0; });
}

// Whether a file written and then let go is still cached: some file systems live in memory, or do not tell.
bool TellsWhatIsCached(const std::filesystem::path& path) {
  if (!WriteDurably(path, "bytes") || !IsCached(path)) return false;
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  return ::posix_fadvise(file.get(), 0, 0, POSIX_FADV_DONTNEED) == 0 && !IsCached(path);
}

TEST_F(Files, OnlyTheNewestStayCached) {
  if (!TellsWhatIsCached(folder_ / "probe")) GTEST_SKIP() << "this file system does not tell what is cached";
  constexpr int kFiles = 4, kFileBytes = 1 << 20;
  CachedFiles cached(2 * kFileBytes);
  for (int i = 0; i < kFiles; ++i) {
    const auto path = folder_ / std::to_string(i);
    ASSERT_TRUE(WriteDurably(path, std::string(kFileBytes, 'x')).has_value());
    cached.Add(path);
  }
  cached.Add(folder_ / "no such file");
  for (int i = 0; i < kFiles; ++i) EXPECT_EQ(IsCached(folder_ / std::to_string(i)), i >= 2) << i;
  EXPECT_EQ(ReadFile(folder_ / "0", kFileBytes).value(), std::string(kFileBytes, 'x'));
}

TEST_F(Files, EmptyFilesTakeRoomAmongTheCachedToo) {
  if (!TellsWhatIsCached(folder_ / "probe")) GTEST_SKIP() << "this file system does not tell what is cached";
  CachedFiles cached(2 * 4096);
  ASSERT_TRUE(WriteDurably(folder_ / "first", "bytes").has_value());
  cached.Add(folder_ / "first");
  for (const char* name : {"a", "b"}) {
    ASSERT_TRUE(WriteDurably(folder_ / name, "").has_value());
    cached.Add(folder_ / name);
  }
  EXPECT_FALSE(IsCached(folder_ / "first"));
}

TEST_F(Files, WriteReplaces) {
  ASSERT_TRUE(WriteDurably(folder_ / "file", "a long first text").has_value());
  ASSERT_TRUE(WriteDurably(folder_ / "file", "short").has_value());
  EXPECT_EQ(ReadFile(folder_ / "file", 100).value(), "short");
}

// As root /dev/null would be gone for everybody.
TEST_F(Files, WriteReplacesFilesAlone) {
  const std::filesystem::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Status written = WriteDurably(pipe, "bytes");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().what, pipe.string() + " is not a regular file");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  std::filesystem::create_symlink(pipe, folder_ / "to a pipe");
  EXPECT_FALSE(WriteDurably(folder_ / "to a pipe", "bytes"));
}

TEST_F(Files, WriteLeavesALinkInItsPlace) {
  std::filesystem::create_directory(folder_ / "v1");
  std::filesystem::create_symlink("v1/robot.urdf", folder_ / "current");  // where there is nothing yet
  ASSERT_TRUE(WriteDurably(folder_ / "current", "first"));
  ASSERT_TRUE(WriteDurably(folder_ / "current", "second"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "current"));
  EXPECT_EQ(ReadFile(folder_ / "v1" / "robot.urdf", 100).value(), "second");
}

TEST_F(Files, FailedWriteLeavesNothingBehind) {
  ASSERT_TRUE(std::filesystem::create_directory(folder_ / "taken"));
  ASSERT_TRUE(WriteDurably(folder_ / "taken" / "inside", "x").has_value());
  const Status status = WriteDurably(folder_ / "taken", "text");  // a folder cannot be replaced by a file
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::kStorage);
  EXPECT_NE(status.error().what.find("taken"), std::string::npos);
  EXPECT_EQ(EntryCount(), 1U);
}

TEST_F(Files, WriteIntoAMissingFolderNamesThePath) {
  const Status status = WriteDurably(folder_ / "missing" / "file", "text");
  ASSERT_FALSE(status.has_value());
  EXPECT_NE(status.error().what.find("missing"), std::string::npos);
}

TEST_F(Files, ReadRefusesMoreThanTheLimit) {
  ASSERT_TRUE(WriteDurably(folder_ / "file", std::string(200'000, 'x')).has_value());
  EXPECT_EQ(ReadFile(folder_ / "file", 200'000).value().size(), 200'000U);
  EXPECT_EQ(ReadFile(folder_ / "file", std::numeric_limits<std::size_t>::max()).value().size(), 200'000U);
  const auto refused = ReadFile(folder_ / "file", 199'999);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
  EXPECT_FALSE(ReadFile(folder_ / "file", 0).has_value());
}

TEST_F(Files, ReadTellsMissingFromUnfit) {
  EXPECT_EQ(ReadFile(folder_ / "missing", 10).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ReadFile(folder_, 10).error().code, ErrorCode::kInvalidInput);
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(ReadFile(folder_ / "pipe", 10).error().code, ErrorCode::kInvalidInput);
}

TEST_F(Files, SyncNamesWhatIsMissing) {
  EXPECT_TRUE(SyncFolder(folder_).has_value());
  EXPECT_FALSE(SyncFolder(folder_ / "missing").has_value());
  ASSERT_TRUE(WriteDurably(folder_ / "file", "x").has_value());
  EXPECT_TRUE(SyncFile(folder_ / "file").has_value());
  EXPECT_FALSE(SyncFolder(folder_ / "file").has_value());
}

// FIPS 180-4 examples; the million letters in one and in many pieces.
TEST_F(Files, Sha256KnownAnswers) {
  EXPECT_EQ(Sha256Of("").str(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256Of("abc").str(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const std::string million(1'000'000, 'a');
  const std::string expected = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
  EXPECT_EQ(Sha256Of(million).str(), expected);
  Sha256 pieces;
  for (std::size_t i = 0; i < million.size(); i += 1000) pieces.Add(std::string_view(million).substr(i, 1000));
  EXPECT_EQ(pieces.Finish().str(), expected);
  ASSERT_TRUE(WriteDurably(folder_ / "file", million).has_value());
  EXPECT_EQ(Sha256OfFile(folder_ / "file").value().str(), expected);
}

TEST_F(Files, Sha256OfFileReadsBeyondOnePiece) {
  const std::string bytes((1 << 20) + 17, 'b');
  ASSERT_TRUE(WriteDurably(folder_ / "file", bytes).has_value());
  EXPECT_EQ(Sha256OfFile(folder_ / "file").value(), Sha256Of(bytes));
  EXPECT_EQ(Sha256OfFile(folder_ / "missing").error().code, ErrorCode::kNotFound);
}

TEST(ParallelFor, CallsEveryIndexOnce) {
  std::vector<std::atomic<int>> calls(1000);
  ParallelFor(calls.size(), [&](std::size_t i) { ++calls[i]; });
  EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& count) { return count == 1; }));
  ParallelFor(0, [](std::size_t) { FAIL(); });
}

TEST(ParallelFor, PassesExceptionsOn) {
  EXPECT_THROW(ParallelFor(10,
                           [](std::size_t i) {
                             if (i == 7) throw std::runtime_error("seven");
                           }),
               std::runtime_error);
}

// One part throws while the other is within a loop of its own, whose results it then goes by.
TEST(ParallelFor, IsWholeWithinALoopThatIsBrokenOff) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 2);
  std::atomic<bool> has_thrown = false;
  std::atomic<int> done = 0;
  const auto within = [&](std::size_t) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(200);
    while (std::chrono::steady_clock::now() < until) continue;
    ++done;
  };
  const auto part = [&](std::size_t i) {
    if (i == 0) {
      const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
      while (done == 0 && std::chrono::steady_clock::now() < until) continue;
      has_thrown = true;
      throw std::runtime_error("nought");
    }
    ParallelFor(400, within, 0);
  };
  EXPECT_THROW(ParallelFor(2, part), std::runtime_error);
  EXPECT_TRUE(has_thrown);
  EXPECT_EQ(done % 400, 0) << "of 400 parts, of each loop that was begun";
}

}  // namespace
}  // namespace rigcal
