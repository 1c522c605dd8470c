// What is answered of receivers of alerts, and of the calendar of what is due.
#include <gmock/gmock.h>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/answers/lists.h"
#include "storage/alerts/outbox.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using testing::HasSubstr;

class AlertAnswers : public PipelineTest {
 protected:
  Result<std::string> Ask(const std::string& verb, const std::string& parameters) {
    RevisionCache revisions;
    return Answer({*store_, clock_, revisions, {}, ""}, verb, parameters);
  }
};

TEST_F(AlertAnswers, AddressesThatDifferInTheirSecretAloneAreOneSample) {
  ASSERT_TRUE(storage::SetReceivers(*store_, {"http://h/a?token=1", "http://h/b", "http://h/a?token=2"}, clock_.now));
  ASSERT_TRUE(storage::AppendAlert(*store_, formats::StatusAlert(RobotId("r"), 1, StatusWord::kOk, {}, clock_.now)));
  ASSERT_TRUE(storage::MarkDelivered(*store_, "http://h/a?token=2", 1, 200, clock_.now));
  const std::string text = metrics::TextOf(AlertReadings(*store_, {}).value());
  EXPECT_THAT(text, HasSubstr("rigcal_webhook_waiting{url=\"http://h/a\"} 1\n"
                              "rigcal_webhook_waiting{url=\"http://h/b\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("rigcal_webhook_delivered_total{url=\"http://h/a\"} 1\n"
                              "rigcal_webhook_delivered_total{url=\"http://h/b\"} 0\n"));
}

// A slip in its name would give a calendar that is empty for ever.
TEST_F(AlertAnswers, TheCalendarOfASiteAtWhichNobodyIsIsRefused) {
  EXPECT_TRUE(Ask("due_ics", "{}")) << "a fleet without robots has a calendar";
  const auto refused = Ask("due_ics", R"({"site": "hal 3"})");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(refused.error().what, HasSubstr("hal 3"));
}

TEST_F(AlertAnswers, WhoAsksForAnUnknownRigModelIsToldWhereTheyAre) {
  for (const char* verb : {"rig_model", "population"}) {
    const auto refused = Ask(verb, R"({"model": "marz"})");
    ASSERT_FALSE(refused) << verb;
    EXPECT_THAT(refused.error().cure, HasSubstr("rigcal model list")) << "it has no --new-model";
  }
}

}  // namespace
}  // namespace rigcal::pipeline
