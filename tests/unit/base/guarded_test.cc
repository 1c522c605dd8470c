#include "server/base/process/guarded.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "server/base/stamp.h"

namespace rigcal {
namespace {

using ::testing::HasSubstr;

TEST(GuardedTest, GivesWhatTheWorkGives) {
  EXPECT_EQ(Guarded([]() -> Result<int> { return 7; }).value(), 7);
  const Status failed = Guarded([]() -> Status { return Fail(ErrorCode::kBusy, "it is busy", "Wait."); });
  EXPECT_EQ(failed.error().code, ErrorCode::kBusy);
}

TEST(GuardedTest, SaysThatThereWasNoMemory) {
  const auto done = Guarded([]() -> Result<int> { throw std::bad_alloc(); });
  EXPECT_EQ(done.error().code, ErrorCode::kInternal);
  EXPECT_THAT(done.error().what, HasSubstr("no memory left"));
}

TEST(GuardedTest, SaysWhatElseWasThrown) {
  const auto done = Guarded([]() -> Result<int> { throw std::runtime_error("an odd picture"); });
  EXPECT_THAT(done.error().what, HasSubstr("an odd picture"));
}

TEST(GuardedTest, BeginsAgainUntilThereIsMemory) {
  int tries = 0;
  const int got = OnceThereIsMemory([&] {
    if (++tries < 3) throw std::bad_alloc();
    return tries;
  });
  EXPECT_EQ(got, 3);
}

TEST(GuardedTest, LeavesOtherExceptionsToTheCaller) {
  EXPECT_THROW(OnceThereIsMemory([] { throw std::runtime_error("not of memory"); }), std::runtime_error);
}

TEST(GuardedTest, GoesRoundAfterAFailureWhichItsPartTells) {
  Part part("of the test", std::chrono::hours(1), SystemClock());
  int rounds = 0;
  GoRound(&part, [&] {
    if (++rounds == 1) throw std::bad_alloc();
    if (rounds == 2) {
      EXPECT_THAT(part.State(std::chrono::steady_clock::now()).problem->what, HasSubstr("no memory left"));
    }
    part.Turn();
    return rounds < 3;
  });
  EXPECT_EQ(rounds, 3);
  EXPECT_FALSE(part.State(std::chrono::steady_clock::now()).problem.has_value());
}

}  // namespace
}  // namespace rigcal
