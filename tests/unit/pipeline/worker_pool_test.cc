// Processes that carry out orders: what they say, and what becomes of an order when one ends.
#include "server/pipeline/workers/worker_pool.h"

#include <gtest/gtest.h>

#include <csignal>

#include "server/base/limits_in_force.h"
#include "server/base/process/memory_budget.h"
#include "server/metrics/exposition.h"
#include "server/pipeline/workers/worker.h"

namespace rigcal::pipeline {
namespace {

[[maybe_unused]] const auto kIgnoredAsRigcaldDoes = std::signal(SIGPIPE, SIG_IGN);

// A shell that does `script` for each order; "$order" is the line.
WorkerPool::Options Shell(const std::string& script, std::chrono::seconds order_max = std::chrono::seconds(60)) {
  return {{"worker", "-c", "while read order; do echo begun; " + script + "; done"}, "/bin/sh", order_max};
}

TEST(WorkerPool, AnOrderIsDoneByOneProcessAfterTheOther) {
  WorkerPool pool(Shell("printf 'done\\t%s by %s\\n' \"$order\" $$"));
  const auto first = pool.Run("one"), second = pool.Run("two");
  ASSERT_TRUE(first.said && second.said);
  EXPECT_EQ(first.said->substr(0, 7), "one by ");
  EXPECT_EQ(second.said->substr(0, 7), "two by ");
  EXPECT_EQ(first.said->substr(7), second.said->substr(7));  // it is kept warm
}

TEST(WorkerPool, AnErrorComesBackAsItIs) {
  WorkerPool pool(Shell("printf 'failed\\t6\\tthe disk is full\\tMake room.\\n'"));
  const auto outcome = pool.Run("one");
  ASSERT_FALSE(outcome.said);
  EXPECT_FALSE(outcome.died);
  EXPECT_EQ(outcome.said.error().code, ErrorCode::kStorage);
  EXPECT_EQ(outcome.said.error().what, "the disk is full");
  EXPECT_EQ(outcome.said.error().cure, "Make room.");
}

TEST(WorkerPool, WhatAProcessSpentIsCountedHere) {
  const auto count = [](const std::string& name) {
    const std::string text = metrics::TextOf({});
    return std::stod(text.substr(text.find("\n" + name + " ") + 1 + name.size()));
  };
  const std::string runs = R"(rigcal_stage_duration_seconds_count{stage="detect"})",
                    sum = R"(rigcal_stage_duration_seconds_sum{stage="detect"})";
  const std::string failures = R"(rigcal_stage_failures_total{stage="detect"})",
                    errors = R"(rigcal_errors_total{kind="storage"})";
  const double runs_before = count(runs), sum_before = count(sum), failures_before = count(failures),
               errors_before = count(errors);
  WorkerPool pool(
      Shell("printf "
            "'spent\\tdetect\\t1.5\\tdone\\nspent\\tdetect\\t0."
            "5\\tfailed\\nspent\\tnothing\\t1\\tdone\\nerred\\tstorage\\ndone\\tgood\\n'"));
  ASSERT_TRUE(pool.Run("one").said);
  EXPECT_EQ(count(runs), runs_before + 2);
  EXPECT_NEAR(count(sum), sum_before + 2.0, 1e-9);
  EXPECT_EQ(count(failures), failures_before + 1);
  EXPECT_EQ(count(errors), errors_before + 1);
}

TEST(WorkerPool, TheEndOfAProcessIsTold) {
  WorkerPool killed(Shell("kill -SEGV $$")), left(Shell("exit 7"));
  const auto by_signal = killed.Run("one"), by_itself = left.Run("one");
  EXPECT_TRUE(by_signal.died && by_itself.died);
  EXPECT_NE(by_signal.said.error().what.find("signal 11 (Segmentation fault)"), std::string::npos);
  EXPECT_NE(by_itself.said.error().what.find("exit code 7"), std::string::npos);
}

TEST(WorkerPool, WhatTakesTooLongIsEnded) {
  WorkerPool pool(Shell("exec sleep 600", std::chrono::seconds(1)));
  const auto outcome = pool.Run("one");
  EXPECT_TRUE(outcome.died);
  EXPECT_NE(outcome.said.error().what.find("longer"), std::string::npos);
}

TEST(WorkerPool, OneThatEndedWhileItWasIdleCostsNothing) {
  WorkerPool pool(Shell("printf 'done\\tgood\\n'; exit 1"));
  for (int i = 0; i < 5; ++i) {
    const auto outcome = pool.Run("one");
    ASSERT_TRUE(outcome.said) << Sentence(outcome.said.error());
    EXPECT_EQ(*outcome.said, "good");
  }
}

TEST(WorkerPool, OneThatDoesNotStartIsToldAndHasNotDied) {
  WorkerPool missing({{"worker"}, "/nowhere/at/all"}), mute({{"worker", "-c", "exit 0"}, "/bin/sh"});
  for (WorkerPool* pool : {&missing, &mute}) {
    const auto outcome = pool->Run("one");
    ASSERT_FALSE(outcome.said);
    EXPECT_FALSE(outcome.died);
    EXPECT_EQ(outcome.said.error().code, ErrorCode::kStorage);
  }
}

// The budget is the server's: what one process has taken, no other thread gets, until it gives it back or ends.
TEST(WorkerPool, MemoryIsTakenFromTheServersBudget) {
  const std::int64_t all = limits::InForce().decoded_bytes;
  const std::string take = "printf 'take\\t1\\t" + std::to_string(all) + "\\n'; read granted; ";
  WorkerPool gives(Shell(take + "printf 'give\\t1\\ndone\\tgood\\n'")), dies(Shell(take + "exit 3"));
  for (int i = 0; i < 3; ++i) {
    const auto outcome = gives.Run("one");
    ASSERT_TRUE(outcome.said);
    EXPECT_TRUE(dies.Run("one").died);
  }
  EXPECT_TRUE(DecodingBudget().Take(all));
}

TEST(WorkerPool, OrdersAreOneLineWhateverIsInThem) {
  const std::string order = PublishOrder({RobotId("r"), 7}, "not\tshown:\nno memory");
  EXPECT_EQ(order.find('\n'), std::string::npos);
  EXPECT_EQ(WorkerFields(order), (std::vector<std::string>{"publish", "r", "7", "not shown: no memory"}));
  EXPECT_EQ(WorkerFields("done\t"), (std::vector<std::string>{"done", ""}));
}

}  // namespace
}  // namespace rigcal::pipeline
