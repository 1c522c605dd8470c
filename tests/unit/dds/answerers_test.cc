// Answers are worked out side by side, and no client holds up another.
#include "server/dds/requests/answerers.h"

#include <atomic>

#include "tests/unit/storage/fixture.h"

namespace rigcal::dds {
namespace {

using std::chrono::seconds;

class AnswerersTest : public storage::StoreTest {
 protected:
  std::vector<Answerers::Place> Places(int count) {
    std::vector<Answerers::Place> places;
    for (int i = 0; i < count; ++i) places.push_back({storage::Store::Open(folder_.path()).value(), nullptr});
    return places;
  }
  // "slow" ends when it may.
  Answerers::Work Work() {
    return [this](storage::Store&, const std::string& verb, const std::string& json) {
      ++worked_;
      if (verb == "slow") may_end_.wait();
      if (verb == "status") status_was_ = worked_.load();
      return verb + json;
    };
  }
  using Answer = std::optional<std::shared_future<std::string>>;
  static std::string Of(const Answer& answer) {
    if (!answer) return "refused";
    return answer->wait_for(seconds(30)) == std::future_status::ready ? answer->get() : "nothing";
  }

  std::promise<void> end_;
  std::shared_future<void> may_end_ = end_.get_future().share();
  std::atomic<int> worked_ = 0, done_ = 0, status_was_ = 0;
};

TEST_F(AnswerersTest, ASlowQuestionHoldsUpNoOther) {
  Answerers answerers(Places(2), Work(), [this] { ++done_; });
  const auto slow = answerers.Ask(1, "slow", "");
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(Of(answerers.Ask(2, "status", std::to_string(i))), "status" + std::to_string(i));
  EXPECT_EQ(slow->wait_for(seconds(0)), std::future_status::timeout);
  end_.set_value();
  EXPECT_EQ(Of(slow), "slow");
}

TEST_F(AnswerersTest, AQuestionAskedAgainIsNotWorkedOutAgain) {
  {
    Answerers answerers(Places(4), Work(), [this] { ++done_; });
    const auto first = answerers.Ask(1, "slow", ""), again = answerers.Ask(1, "slow", "");
    const auto of_another = answerers.Ask(2, "slow", "");  // it may ask for what the first could not know
    end_.set_value();
    EXPECT_EQ(Of(first) + Of(again) + Of(of_another), "slowslowslow");
    EXPECT_EQ(worked_, 2);
    EXPECT_EQ(Of(answerers.Ask(1, "slow", "")), "slow");  // once it was answered it is another question
  }
  EXPECT_EQ(worked_, 3);
  EXPECT_EQ(done_, 3);
}

TEST_F(AnswerersTest, OneClientDoesNotTakeAllThreads) {
  Answerers answerers(Places(3), Work(), [this] { ++done_; });
  std::vector<Answer> slow;
  for (int i = 0; i < 10; ++i) slow.push_back(answerers.Ask(1, "slow", std::to_string(i)));
  EXPECT_EQ(Of(answerers.Ask(2, "status", "")), "status");
  EXPECT_LE(worked_, 3);
  end_.set_value();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(Of(slow[static_cast<std::size_t>(i)]), "slow" + std::to_string(i));
}

TEST_F(AnswerersTest, WhatWasBegunBeforeAnOrderIsNoAnswerAfterIt) {
  Answerers answerers(Places(4), Work(), [this] { ++done_; });
  const auto before = answerers.Ask(1, "slow", "");
  answerers.Changed();
  const auto after = answerers.Ask(1, "slow", "");
  end_.set_value();
  EXPECT_EQ(Of(before) + Of(after), "slowslow");
  EXPECT_EQ(worked_, 2);
}

TEST_F(AnswerersTest, BeyondItsLimitsQuestionsAreRefusedAndOthersServedFirst) {
  Answerers answerers(Places(1), Work(), [this] { ++done_; });
  std::vector<Answer> flood;
  for (int i = 0; i < 200; ++i)
    for (const std::uint64_t client : {1, 2}) flood.push_back(answerers.Ask(client, "slow", std::to_string(i)));
  EXPECT_FALSE(flood.back());
  const auto other = answerers.Ask(3, "status", "");
  end_.set_value();
  EXPECT_EQ(Of(other), "status");
  EXPECT_LE(status_was_, 3);  // each of the others once
  for (const Answer& answer : flood)
    if (answer) Of(answer);
}

TEST_F(AnswerersTest, WhatWaitsWhenItEndsGetsNoAnswerAndHoldsUpNobody) {
  Answer waiting;
  {
    Answerers answerers(Places(1), Work(), [this] { ++done_; });
    const auto slow = answerers.Ask(1, "slow", "");
    waiting = answerers.Ask(2, "status", "");
    end_.set_value();
    EXPECT_EQ(Of(slow), "slow");
  }
  EXPECT_EQ(waiting->wait_for(seconds(30)), std::future_status::ready);  // answered, or given up
}

}  // namespace
}  // namespace rigcal::dds
