#include "server/base/process/last_run.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace rigcal {
namespace {

class LastRunTest : public testing::Test {
 protected:
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("rigcal-last-run-" + std::to_string(getpid()));
  LastRunTest() { std::filesystem::create_directories(folder_); }
  ~LastRunTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string Noted() const {
    std::stringstream text;
    text << std::ifstream(folder_ / "run").rdbuf();
    return text.str();
  }
  void Note(const std::string& text) const { std::ofstream(folder_ / "run") << text; }

  // A process of its own that serves from the folder and ends so.
  template <typename End>
  int StatusOf(const End& end) const {
    const pid_t child = fork();
    if (child == 0) {
      BeginRun(folder_);
      end();
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return status;
  }
};

TEST_F(LastRunTest, OfTheFirstNothingIsKnown) { EXPECT_EQ(EndOfLastRun(folder_), RunEnd::kMayBeItsOwn); }

TEST_F(LastRunTest, AKillComesFromOutside) {
  const int status = StatusOf([] { kill(getpid(), SIGKILL); });
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
  if (Noted() == "-") GTEST_SKIP() << "/proc does not tell the boot and what was killed for want of memory";
  EXPECT_EQ(EndOfLastRun(folder_), RunEnd::kFromOutside);
}

TEST_F(LastRunTest, ACrashIsItsOwn) {
  for (const auto& [end, signal] :
       {std::pair{+[] { std::abort(); }, SIGABRT}, std::pair{+[] { raise(SIGSEGV); }, SIGSEGV}}) {
    const int status = StatusOf(end);
    ASSERT_TRUE(WIFSIGNALED(status)) << signal;
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(EndOfLastRun(folder_), RunEnd::kMayBeItsOwn);
    EXPECT_EQ(EndOfLastRun(folder_), RunEnd::kMayBeItsOwn);  // until the next run begins
  }
}

TEST_F(LastRunTest, WhatCannotBeNotedMayBeItsOwn) {
  BeginRun(folder_);
  std::filesystem::create_directories(folder_ / "gone");
  BeginRun(folder_ / "gone");
  std::filesystem::remove_all(folder_ / "gone");
  BeginRun(folder_ / "gone");  // warns, and goes on
  EXPECT_EQ(EndOfLastRun(folder_ / "gone"), RunEnd::kMayBeItsOwn);
}

TEST_F(LastRunTest, WhereTheSystemKilledForMemoryItMayBeItsOwnButNotAcrossABoot) {
  BeginRun(folder_);
  const std::string now = Noted();
  if (now == "-") GTEST_SKIP() << "/proc does not tell the boot and what was killed for want of memory";
  Note(now.substr(0, now.find('\n')) + "\noom_kill 987654321\n");
  EXPECT_EQ(EndOfLastRun(folder_), RunEnd::kMayBeItsOwn);
  Note("-another boot\noom_kill 987654321\n");
  EXPECT_EQ(EndOfLastRun(folder_), RunEnd::kFromOutside);
}

}  // namespace
}  // namespace rigcal
