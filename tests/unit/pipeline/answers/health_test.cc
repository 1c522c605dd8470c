// What /readyz and /healthz say.
#include "server/pipeline/answers/health.h"

#include <gmock/gmock.h>

#include "server/pipeline/answers/answer.h"
#include "storage/database/refused_pages.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using testing::HasSubstr;

class HealthTest : public PipelineTest {
 protected:
  PageText Page(const char* path) {
    return *AnswerPage({*store_, clock_, cache_, clock_.now, "", &*health_}, path, "");
  }
  PageText Healthz() { return Page("/healthz"); }
  PageText Readyz() { return Page("/readyz"); }
  // As after more than a second.
  void LookAnew() { health_.emplace(folder_, clock_); }
  RevisionCache cache_;
  std::optional<ServerHealth> health_;
};

TEST_F(HealthTest, ReadyUntilAPartFailsAndReadyAgain) {
  LookAnew();
  Part& intake = health_->vitals().Expect("intake", std::chrono::seconds(30));
  EXPECT_EQ(Readyz().status, 200);
  EXPECT_EQ(Readyz().body, "ready\n");
  intake.Fail({ErrorCode::kInternal, "waiting failed", "Restart it."});
  EXPECT_EQ(Readyz().status, 503);
  EXPECT_EQ(Readyz().body, "waiting failed. Restart it.\n");
  const PageText alive = Healthz();
  EXPECT_EQ(alive.status, 200) << "it tries again by itself";
  EXPECT_THAT(alive.body, HasSubstr(R"("state":"failing")"));
  EXPECT_THAT(alive.body, HasSubstr(R"({"failures":1,"name":"intake","problem":{"code":"internal","cure":"Restart )"
                                    R"(it.","what":"waiting failed"},"since":"2027-)"));
  intake.Turn();
  EXPECT_EQ(Readyz().status, 200);
}

TEST_F(HealthTest, APartThatStandsStillIsNotAlive) {
  LookAnew();
  Part& intake = health_->vitals().Expect("intake", std::chrono::milliseconds(-1));
  EXPECT_EQ(Healthz().status, 503);
  EXPECT_THAT(Readyz().body, HasSubstr("the part 'intake' of the server stands still"));
  intake.Rest();
  EXPECT_EQ(Healthz().status, 200);
}

TEST_F(HealthTest, DiskThatTakesNothingIsToldByName) {
  const auto intake = store_->IntakeFolder(), away = folder_ / "away";
  std::filesystem::rename(intake, away);
  std::ofstream(intake) << "in the way";
  LookAnew();
  const PageText failing = Readyz();
  EXPECT_EQ(failing.status, 503);
  EXPECT_THAT(failing.body, HasSubstr("the disk of the data folder " + folder_.string() + " cannot store anything: "));
  EXPECT_EQ(std::count(failing.body.begin(), failing.body.end(), '\n'), 1) << failing.body;
  EXPECT_EQ(Healthz().status, 200) << "a restart does not help";
  std::filesystem::remove(intake);
  std::filesystem::rename(away, intake);
  EXPECT_EQ(Readyz().status, 503) << "looked again within a second";
  LookAnew();
  EXPECT_EQ(Readyz().status, 200);
  EXPECT_TRUE(std::filesystem::is_empty(intake));
}

TEST_F(HealthTest, ADamagedPageIsToldUntilItIsGood) {
  const auto database = std::filesystem::canonical(folder_ / "rigcal.db");
  storage::NoteRefused({folder_ / "elsewhere" / "rigcal.db", 3});
  LookAnew();
  EXPECT_EQ(Readyz().status, 200) << "of another store";
  storage::NoteRefused({database, 16});
  LookAnew();
  EXPECT_EQ(Readyz().status, 503);
  EXPECT_THAT(Readyz().body, HasSubstr("the database: page 16 of " + database.string() + " is not as rigcald wrote"));
  EXPECT_EQ(Healthz().status, 200) << "a restart does not help";
  storage::NoteGood(database, 16);
  LookAnew();
  EXPECT_EQ(Readyz().status, 200);
}

TEST_F(HealthTest, StatusAndMetricsSayTheSame) {
  LookAnew();
  health_->vitals().Expect("intake", std::chrono::seconds(30)).Fail({ErrorCode::kInternal, "waiting failed", "Do."});
  const AnswerContext context{*store_, clock_, cache_, clock_.now, "", &*health_};
  EXPECT_THAT(*Answer(context, "status", "{}"), HasSubstr(R"("what":"waiting failed")"));
  const std::string metrics = AnswerPage(context, "/metrics", "")->body;
  EXPECT_THAT(metrics, HasSubstr("rigcal_part_failing{part=\"intake\"} 1\n"));
  EXPECT_THAT(metrics, HasSubstr("rigcal_part_failing{part=\"disk\"} 0\n"));
  EXPECT_THAT(metrics, HasSubstr("rigcal_part_failures_total{part=\"intake\"} 1\n"));
}

}  // namespace
}  // namespace rigcal::pipeline
