// A report whose folder is gone comes back, byte by byte; what cannot be drawn says why.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/reports/kept_reports.h"
#include "server/pipeline/reports/publish.h"
#include "storage/sessions/standing.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;

Files FilesIn(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::stringstream bytes;
    bytes << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    files[entry.path().lexically_relative(folder).string()] = bytes.str();
  }
  return files;
}

class MissingReportTest : public PipelineTest {
 protected:
  void SetUp() override {
    PipelineTest::SetUp();
    StoreEdges(Triangle("r"));
    StepAll();
    clock_.now.ns += 3'600'000'000'000;
  }
  fs::path Report(int number) { return store_->ReportFolder() / "r" / std::to_string(number); }
  // How the page of a report that is missing is answered.
  Error Ask(const std::string& rest = "revisions/1/") {
    const auto page = AnswerPage({*store_, clock_, cache_, clock_.now, "", nullptr, &undrawn_, [this] { ++woken_; }},
                                 "/robots/r/" + rest, "");
    EXPECT_FALSE(page);
    return page ? Error{} : page.error();
  }
  Result<StepResult> StepOnce() { return Step({*store_, clock_, live_, claims_, announcer_, cameras_, &undrawn_}); }

  RevisionCache cache_;
  UndrawnReports undrawn_;
  int woken_ = 0;
};

TEST_F(MissingReportTest, IsDrawnAgainWithTheSameBytes) {
  const Files first = FilesIn(Report(1));
  ASSERT_TRUE(first.contains("index.html"));
  fs::remove_all(Report(1));
  const Error again = Ask();
  EXPECT_EQ(again.code, ErrorCode::kBusy);
  EXPECT_EQ(again.what, "the report of revision 1 of r is being drawn again, as its folder was gone");
  EXPECT_EQ(Ask().code, ErrorCode::kBusy);
  EXPECT_EQ(woken_, 1);
  EXPECT_EQ(StepAll(), 1);
  EXPECT_EQ(FilesIn(Report(1)), first);
}

TEST_F(MissingReportTest, OlderOnesLookAsTheyDid) {
  const Files first = FilesIn(Report(1));
  std::vector<Edge> more = {GivenEdge("r", "a", "d", 4.0)};
  AssignPushedIds(more);
  StoreEdges(more);
  StepAll();
  const Files second = FilesIn(Report(2));
  fs::remove_all(store_->ReportFolder() / "r");
  EXPECT_EQ(Ask("revisions/1/").code, ErrorCode::kBusy);
  EXPECT_EQ(Ask("revisions/2/").code, ErrorCode::kBusy);
  EXPECT_EQ(StepAll(), 2);
  EXPECT_EQ(FilesIn(Report(1)), first);
  EXPECT_EQ(FilesIn(Report(2)), second);
}

// Revision 1 was in use when 2 failed; 3 is since.
TEST_F(MissingReportTest, WhatToUseIsToldAsItWasWhenTheRevisionWasMade) {
  std::vector<Edge> wrong = {GivenEdge("r", "a", "b", 7.0)};
  AssignPushedIds(wrong);
  StoreEdges(wrong);
  StepAll();
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kFail) << revisions_.back().verdict.why;
  const Files first = FilesIn(Report(2));
  EXPECT_THAT(first.at("index.html"), testing::HasSubstr("revision 1"));
  ASSERT_TRUE(storage::RetireEdge(*store_, wrong.front().id, {clock_.now, "Ada", "typed wrong"}));
  StepAll();
  ASSERT_EQ(InUse(), 3);
  fs::remove_all(Report(2));
  EXPECT_EQ(Ask("revisions/2/").code, ErrorCode::kBusy);
  EXPECT_EQ(StepAll(), 1);
  EXPECT_EQ(FilesIn(Report(2)), first);
}

TEST_F(MissingReportTest, TheSoftwareIsThatWhichSolvedTheRevision) {
  store_->database().exec(
      "DROP TRIGGER revision_made_no_update; DROP TRIGGER revision_made_no_delete; "
      "UPDATE revision_made SET software = '0.0.7'");
  fs::remove_all(Report(1));
  EXPECT_EQ(Ask().code, ErrorCode::kBusy);
  StepAll();
  EXPECT_THAT(FilesIn(Report(1)).at("index.html"), testing::HasSubstr("rigcald <bdi>0.0.7</bdi>"));
  store_->database().exec("DELETE FROM revision_made");  // as older versions left it
  fs::remove_all(Report(1));
  EXPECT_EQ(Ask().code, ErrorCode::kBusy);
  StepAll();
  EXPECT_THAT(FilesIn(Report(1)).at("index.html"),
              testing::HasSubstr("rigcald <bdi>of a version that was not recorded</bdi>"));
}

TEST_F(MissingReportTest, WhatCannotBeDrawnSaysWhy) {
  fs::remove_all(store_->ReportFolder() / "r");
  std::ofstream(store_->ReportFolder() / "r") << "in the way";
  EXPECT_EQ(Ask().code, ErrorCode::kBusy);
  EXPECT_FALSE(StepOnce());
  const Error why = Ask();
  EXPECT_EQ(why.code, ErrorCode::kNotFound);
  EXPECT_THAT(why.what, testing::StartsWith("the report of revision 1 of r could not be drawn: the report folder "));
  EXPECT_FALSE(why.cure.empty());
  fs::remove(store_->ReportFolder() / "r");
  EXPECT_TRUE(StepOnce());
  EXPECT_TRUE(fs::exists(Report(1) / "index.html"));
  fs::remove_all(Report(1));
  EXPECT_EQ(Ask().code, ErrorCode::kBusy);
}

TEST_F(MissingReportTest, WhatCameMeanwhileIsAskedForAgain) {
  EXPECT_EQ(Ask().code, ErrorCode::kBusy);
  EXPECT_EQ(StepAll(), 0);
}

TEST_F(MissingReportTest, WhatNeverWasIsNotThere) {
  EXPECT_EQ(Ask("revisions/2/").what, "r has no revision 2");
  EXPECT_EQ(Ask("revisions/1/evidence/x.png").what, "the report of revision 1 of r has no file evidence/x.png");
  for (const std::string rest : {"revisions/2/", "revisions/1/evidence/x.png", "revisions/0/", "revisions/x/",
                                 "revisions/99999999999/", "revisions/1x/"})
    EXPECT_EQ(Ask(rest).code, ErrorCode::kNotFound) << rest;
  EXPECT_EQ(StepAll(), 0);
}

TEST_F(MissingReportTest, FilesThatAreAskedForOverDdsAreDrawnAgain) {
  fs::remove_all(Report(1));
  const AnswerContext context{*store_, clock_, cache_, clock_.now, "", nullptr, &undrawn_, {}};
  const auto none = Answer(context, "report_files", R"({"robot":"r"})");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kBusy);
  StepAll();
  EXPECT_TRUE(Answer(context, "report_files", R"({"robot":"r"})"));
}

TEST_F(MissingReportTest, NewestIsMissedAfterAStart) {
  ASSERT_TRUE(storage::AppendRobot(*store_, RobotId("without-revision"), clock_.now));
  EXPECT_EQ(DrawMissingReports(*store_, RobotId()).value(), RobotId("without-revision"));  // it looked at both
  EXPECT_TRUE(DrawMissingReports(*store_, RobotId("without-revision")).value().empty());
  EXPECT_EQ(StepAll(), 0);
  fs::remove_all(Report(1));
  ASSERT_TRUE(DrawMissingReports(*store_, RobotId("r")));
  EXPECT_EQ(StepAll(), 0) << "those after it";
  ASSERT_TRUE(DrawMissingReports(*store_, RobotId()));
  ASSERT_TRUE(DrawMissingReports(*store_, RobotId()));  // is drawn once all the same
  EXPECT_EQ(StepAll(), 1);
  EXPECT_TRUE(fs::exists(Report(1) / "index.html"));
}

}  // namespace
}  // namespace rigcal::pipeline
