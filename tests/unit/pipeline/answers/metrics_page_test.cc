// What /metrics says of the store, and of what waits outside of it.
#include "server/pipeline/pages/metrics_page.h"

#include <gmock/gmock.h>

#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using testing::HasSubstr;
using testing::Not;

class MetricsPage : public PipelineTest {
 protected:
  std::string Text(std::function<std::vector<metrics::Reading>()> more = {}) {
    const auto page = AnswerMetrics({*store_, clock_, cache_, started_at_, "", nullptr, nullptr, {}, std::move(more)});
    EXPECT_TRUE(page) << (page ? "" : Sentence(page.error()));
    return page ? page->body : "";
  }
  RevisionCache cache_;
  Stamp started_at_ = clock_.now;
};

TEST_F(MetricsPage, AJobThatWaitsGrowsOldUntilItIsDone) {
  StoreSession("r", {{"left/1.png", "no picture"}, {"right/1.png", "none either"}});
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_oldest_job_waiting_seconds 0\n"));
  clock_.now.ns += 90'000'000'000;
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_jobs_waiting 1\n"));
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_oldest_job_waiting_seconds 90\n"));
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_uptime_seconds 90\n"));
  StepAll();
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_jobs_waiting 0\n"));
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_oldest_job_waiting_seconds 0\n"));
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_reports_waiting 0\n"));
}

TEST_F(MetricsPage, WhatWaitsOutsideOfTheStoreIsToldToo) {
  EXPECT_THAT(Text(), Not(HasSubstr("rigcal_questions_waiting")));
  const std::string text = Text([] {
    return std::vector<metrics::Reading>{{"rigcal_questions_waiting", "Questions", 3}};
  });
  EXPECT_THAT(text, HasSubstr("# TYPE rigcal_questions_waiting gauge\nrigcal_questions_waiting 3\n"));
}

TEST_F(MetricsPage, TellsOfTheProcess) {
  EXPECT_THAT(Text(), HasSubstr("\n# TYPE rigcal_resident_memory_bytes gauge\nrigcal_resident_memory_bytes "));
  EXPECT_THAT(Text(), Not(HasSubstr("\nrigcal_open_handles 0\n")));
  EXPECT_THAT(Text(), HasSubstr("\nrigcal_build_info{version=\""));
}

}  // namespace
}  // namespace rigcal::pipeline
