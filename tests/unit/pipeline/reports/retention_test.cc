// Old reports are removed from disk, and drawn again with the same bytes when they are asked for.
#include "server/pipeline/attempt.h"
#include "server/pipeline/reports/kept_reports.h"
#include "storage/revisions/revisions.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

class PipelineRetentionTest : public PipelineTest {
 protected:
  // A revision with its report, at so many days from the first of a month on.
  void Revision(double days) {
    clock_.now.ns =
        1'798'761'600'000'000'000 + static_cast<std::int64_t>(days * static_cast<double>(kDay_ns));  // 2027-01-01
    auto edges = Triangle("r");
    for (Edge& edge : edges) edge.T_a_b.p_m.y() += 1e-5 * ++made_;
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
  }
  std::filesystem::path Report(int number) { return store_->ReportFolder() / "r" / std::to_string(number); }
  std::vector<int> Kept() {
    std::vector<int> kept;
    for (int number = 1; number <= made_ / 3; ++number)
      if (std::filesystem::exists(Report(number))) kept.push_back(number);
    return kept;
  }
  static std::string TextOf(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }

  int made_ = 0;
};

TEST_F(PipelineRetentionTest, TheNewestStayAndOneOfEachMonth) {
  for (const double days : {1, 2, 3, 35, 36, 63, 64, 65}) Revision(days);  // January, February, March
  const auto freed = RemoveOldReports(*store_, RobotId("r"), 2);
  ASSERT_TRUE(freed) << Sentence(freed.error());
  EXPECT_EQ(Kept(), (std::vector<int>{3, 5, 7, 8}));
  EXPECT_EQ(freed->reports, 4);
  EXPECT_GT(freed->bytes, 4000);
  EXPECT_EQ(RemoveOldReports(*store_, RobotId("r"), 2)->reports, 0);
}

TEST_F(PipelineRetentionTest, ARobotKeepsSoManyReportsHoweverOftenItIsRevised) {
  for (int i = 0; i < 25; ++i) Revision(0.1 * i);
  EXPECT_LE(Kept().size(), 21u);
  EXPECT_EQ(Kept().back(), 25);
}

TEST_F(PipelineRetentionTest, OneThatIsAskedForIsDrawnAgainWithTheSameBytes) {
  for (const double days : {1, 2, 3, 4}) Revision(days);
  const std::string before = TextOf(Report(1) / "index.html");
  ASSERT_FALSE(before.empty());
  ASSERT_EQ(RemoveOldReports(*store_, RobotId("r"), 2)->reports, 2);
  UndrawnReports undrawn;
  bool woken = false;
  const Error why = WhyMissing(*store_, undrawn, {RobotId("r"), 1}, "index.html", [&] { woken = true; });
  EXPECT_EQ(why.code, ErrorCode::kBusy);
  EXPECT_TRUE(woken);
  clock_.now.ns += kDay_ns;
  StepAll();
  EXPECT_EQ(TextOf(Report(1) / "index.html"), before);
}

TEST_F(PipelineRetentionTest, ThoseThatCannotBeDrawnHoldUpNoOther) {
  for (const double days : {1, 2, 3, 4, 5, 6}) Revision(days);
  ASSERT_EQ(RemoveOldReports(*store_, RobotId("r"), 1)->reports, 5);
  for (const int number : {1, 2, 3}) {
    ASSERT_TRUE(storage::QueuePublication(*store_, {RobotId("r"), number}));
    const std::string work = storage::WorkOfReport({RobotId("r"), number});
    for (int attempt = 0; attempt < kPublishAttemptsMax; ++attempt) {
      ASSERT_TRUE(storage::BeginAttempt(*store_, work, clock_.now));
      ASSERT_TRUE(storage::EndAttempt(*store_, work, storage::AttemptEnd::kFailed, "no memory", clock_.now));
    }
  }
  UndrawnReports undrawn;
  bool woken = false;
  (void)WhyMissing(*store_, undrawn, {RobotId("r"), 4}, "index.html", [&] { woken = true; });
  EXPECT_TRUE(woken);
  StepAll();
  EXPECT_TRUE(std::filesystem::exists(Report(4) / "index.html"));
}

}  // namespace
}  // namespace rigcal::pipeline
