// A certificate as it stands when somebody asks: its document and its page say the same, whatever was decided since the
// report was drawn.
#include "server/formats/answers/certificate.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class CertificateTest : public PipelineTest {
 protected:
  void SetUp() override {
    PipelineTest::SetUp();
    std::vector<Edge> edges = {GivenEdge("r", "a", "b", 1.0), GivenEdge("r", "b", "c", 1.0),
                               GivenEdge("r", "a", "c", 2.0)};
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
  }
  AnswerContext Context() { return {*store_, clock_, cache_, clock_.now, ""}; }
  Certificate Ask(int revision = 0) {
    const auto answer =
        Answer(Context(), "certificate", R"({"robot":"r","revision":)" + std::to_string(revision) + "}");
    EXPECT_TRUE(answer) << Sentence(answer.error());
    const auto read = formats::ReadCertificate(answer.value_or(""));
    EXPECT_TRUE(read);
    return read.value_or(Certificate{});
  }
  std::string Page(const std::string& revision) {
    const auto page = AnswerPage(Context(), "/robots/r/revisions/" + revision + "/certificate.html", "");
    EXPECT_TRUE(page) << Sentence(page.error());
    return page ? page->body : "";
  }
  void Decide(const std::string& verb) {
    const auto done =
        CarryOut(*store_, clock_, verb, R"({"robot":"r","revision":1,"who":"Eve","reason":"the mast was bent"})");
    ASSERT_TRUE(done) << Sentence(done.error());
  }

  RevisionCache cache_;
};

TEST_F(CertificateTest, DocumentAndPageSayTheSameAndTheReportsCopyNothingOfDecisions) {
  const Certificate certificate = Ask();
  EXPECT_EQ(certificate.revision, 1);
  EXPECT_EQ(certificate.title, "Calibration certificate");
  EXPECT_THAT(certificate.state, HasSubstr("In use: approved by policy, "));
  const std::string page = Page("1");
  EXPECT_THAT(page, AllOf(HasSubstr("<h1>Calibration certificate <"), HasSubstr("class=\"signature\""),
                          HasSubstr("href=\"../../../../style.css\"")));
  EXPECT_THAT(certificate.parts[2].text, Contains("3 edges were pushed as finished results."));
  EXPECT_THAT(page, HasSubstr("3 edges were pushed as finished results."));
  std::stringstream copy;
  copy << std::ifstream(store_->ReportFolder() / "r" / "1" / "certificate.html").rdbuf();
  // The copy looks the same whenever it is drawn: it knows of no decision.
  EXPECT_THAT(copy.str(), AllOf(HasSubstr("3 edges were pushed as finished results."), HasSubstr("href=\"style.css\""),
                                HasSubstr("Whether it is in use, the robot&#39;s page on the server says."),
                                Not(HasSubstr("class=\"signature\""))));
}

TEST_F(CertificateTest, WhatWasRejectedSinceIsNoCertificate) {
  Decide("reject");
  EXPECT_EQ(Ask().title, "Calibration record, no certificate");
  EXPECT_FALSE(Ask().to_sign);
  EXPECT_THAT(Ask().state, HasSubstr("Rejected: rejected by Eve, "));
  EXPECT_THAT(Page("1"), AllOf(HasSubstr("no certificate"), HasSubstr("the mast was bent"),
                               Not(HasSubstr("class=\"signature\""))));
  Decide("approve");
  EXPECT_TRUE(Ask().to_sign);
  EXPECT_THAT(Page("1"), HasSubstr("class=\"signature\""));
}

TEST_F(CertificateTest, OverdueIsNotSigned) {
  clock_.now.ns += 200LL * 86'400'000'000'000;
  EXPECT_EQ(Ask().title, "Calibration record, no certificate");
  EXPECT_THAT(Ask().rule, HasSubstr("overdue since"));
  EXPECT_THAT(Page("1"), AllOf(HasSubstr("overdue since"), Not(HasSubstr("class=\"signature\""))));
}

// It needs no folder on the disk.
TEST_F(CertificateTest, IsThereWithoutTheReport) {
  std::filesystem::remove_all(store_->ReportFolder() / "r" / "1");
  EXPECT_THAT(Page("1"), HasSubstr("<h1>Calibration certificate <"));
  for (const std::string number : {"2", "0", "x"})
    EXPECT_FALSE(AnswerPage(Context(), "/robots/r/revisions/" + number + "/certificate.html", "")) << number;
  EXPECT_EQ(Answer(Context(), "certificate", R"({"robot":"nobody"})").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace rigcal::pipeline
