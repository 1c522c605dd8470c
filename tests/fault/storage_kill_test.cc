// kill -9 at random moments: what was acknowledged is there, what was not is there whole or not at all.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <random>

#include "storage/files/blobs.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kRounds = 20;
constexpr int kEdgesPerCommit = 3;
constexpr std::size_t kBlobBytesMax = 1 << 20;

int SeedOf(int commit, int edge) { return commit * kEdgesPerCommit + edge; }
std::string BlobTextOf(int commit) {
  return std::string(50'000, static_cast<char>('a' + commit % 26)) + std::to_string(commit);
}

Status Commit(Store& store, int commit) {
  RIGCAL_TRY(AppendBlob(store.BlobFolder(), BlobTextOf(commit)));
  return store.Write([&]() -> Status {
    for (int i = 0; i < kEdgesPerCommit; ++i) RIGCAL_TRY(AppendEdge(store, MakeEdge(SeedOf(commit, i)), {1}));
    return {};
  });
}

// Commits first, first + 1, ... and names each in the pipe once it is durable, until it is killed.
[[noreturn]] void RunChild(const fs::path& folder, int first, int pipe_end) {
  Result<Store> store = Store::Open(folder);
  if (!store) _exit(1);
  for (int commit = first;; ++commit) {
    if (!Commit(*store, commit)) _exit(2);
    if (write(pipe_end, &commit, sizeof commit) != sizeof commit) _exit(3);
  }
}

// The last number in the pipe, or `last` if there is none; waits for it up to `wait_ms`, -1: until it comes.
int ReadAcknowledged(int pipe_end, int last, int wait_ms) {
  pollfd ready{pipe_end, POLLIN, 0};
  if (poll(&ready, 1, wait_ms) <= 0) return last;
  int commit = last;
  return read(pipe_end, &commit, sizeof commit) == sizeof commit ? commit : last;
}

// Runs a child from commit `first` on and kills it; the last commit that it acknowledged.
int KillAtRandomMoment(const fs::path& folder, int first, int moment_us) {
  int ends[2];
  if (pipe(ends) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) RunChild(folder, first, ends[1]);
  close(ends[1]);
  int last = ReadAcknowledged(ends[0], first - 1, -1);
  using Clock = std::chrono::steady_clock;
  const auto moment = Clock::now() + std::chrono::microseconds(moment_us);
  while (Clock::now() < moment) last = ReadAcknowledged(ends[0], last, 1);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  // What it acknowledged before it died is still in the pipe.
  for (int before = last - 1; before != last;) {
    before = last;
    last = ReadAcknowledged(ends[0], last, 0);
  }
  close(ends[0]);
  return last;
}

int EdgesOf(Store& store, int commit) {
  int stored = 0;
  for (int i = 0; i < kEdgesPerCommit; ++i) {
    const std::optional<Edge> edge = LoadEdge(store, MakeEdge(SeedOf(commit, i)).id).value();
    if (edge && edge->uncertainty.blocks.size() == 3 && edge->evidence.size() == 1) ++stored;
  }
  return stored;
}

// No half-written file is left either.
void CheckBlobs(const fs::path& blob_folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(blob_folder)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(Sha256OfFile(entry.path()).value().str(), entry.path().filename().string());
  }
}

TEST(Kill, NothingAcknowledgedIsLost) {
  const rigcal::TempFolder folder;  // on a disk
  std::mt19937 random(20190801);
  std::uniform_int_distribution<int> moment_us(0, 40'000);
  int next = 0;
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const int last = KillAtRandomMoment(folder.path(), next, moment_us(random));
    ASSERT_GE(last, next) << "the child did not get as far as its first commit";
    Result<Store> store = Store::Open(folder.path());
    ASSERT_TRUE(store) << WordsOf(store);
    for (int commit = 0; commit <= last; ++commit) {
      ASSERT_EQ(EdgesOf(*store, commit), kEdgesPerCommit) << "commit " << commit << " of " << last;
      ASSERT_EQ(LoadBlob(store->BlobFolder(), DigestOf(BlobTextOf(commit)), kBlobBytesMax).value(), BlobTextOf(commit));
    }
    const int unacknowledged = EdgesOf(*store, last + 1);
    EXPECT_TRUE(unacknowledged == 0 || unacknowledged == kEdgesPerCommit) << unacknowledged;
    EXPECT_EQ(EdgesOf(*store, last + 2), 0);
    CheckBlobs(store->BlobFolder());
    next = last + 1;
  }
}

}  // namespace
}  // namespace rigcal::storage
