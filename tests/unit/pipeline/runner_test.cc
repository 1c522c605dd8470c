// The threads that work: a job that takes for hours keeps no other robot from its revision.
#include "server/pipeline/runner.h"

#include <future>

#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

constexpr std::chrono::seconds kJobMax{120};

class RunnerTest : public PipelineTest {
 protected:
  // The job of a robot of that name takes until `end_job_`.
  void SetUp() override {
    PipelineTest::SetUp();
    announcer_.state = [](const RobotId&) {};
    announcer_.event = [this](const RobotId& robot, const std::string& kind, const std::string&, const std::string&) {
      if (robot == RobotId("other") && kind == "published") published_.set_value();
      if (robot != RobotId("busy")) return;
      if (kind == "edge") calibrated_.set_value();
      if (kind != "session_closed") return;
      begun_.set_value();
      end_job_.get_future().wait_for(kJobMax);
    };
    options_.place = folder_;
    options_.clock = &clock_;
    options_.threads = 1;
    options_.vitals = &vitals_;
  }
  [[nodiscard]] std::vector<std::string> Parts() const {
    std::vector<std::string> names;
    for (const PartState& part : vitals_.States()) names.push_back(part.name);
    return names;
  }

  std::promise<void> begun_, end_job_, calibrated_, published_;
  Vitals vitals_{clock_};
  Runner::Options options_;
};

TEST_F(RunnerTest, RobotsAreRevisedWhileJobsHoldAllThreadsThatTakeThem) {
  StoreSession("busy", {{"left/01.png", "no picture"}, {"right/01.png", "none either"}});
  auto runner = Runner::Start(options_, announcer_);
  ASSERT_TRUE(runner) << Sentence(runner.error());
  EXPECT_EQ(Parts(), (std::vector<std::string>{"calibration 1", "revisions"}));
  const bool begun = begun_.get_future().wait_for(kJobMax) == std::future_status::ready;
  StoreEdges(Triangle("other"));
  runner->Wake();
  const bool published = published_.get_future().wait_for(kJobMax / 2) == std::future_status::ready;
  end_job_.set_value();
  EXPECT_TRUE(begun);
  EXPECT_TRUE(published);
  EXPECT_EQ(calibrated_.get_future().wait_for(kJobMax), std::future_status::ready);
}

TEST_F(RunnerTest, WithoutThreadsThatTakeJobsThereIsNone) {
  options_.threads = 0;
  auto runner = Runner::Start(options_, announcer_);
  ASSERT_TRUE(runner) << Sentence(runner.error());
  EXPECT_TRUE(Parts().empty());
}

}  // namespace
}  // namespace rigcal::pipeline
