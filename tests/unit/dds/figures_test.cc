// What the service tells operators: what waits now, what happened, and a line of the log for each receipt and refusal.
#include <gmock/gmock.h>

#include "server/base/log.h"
#include "server/metrics/exposition.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using testing::HasSubstr;

double FigureOf(const std::vector<metrics::Reading>& readings, const std::string& name) {
  for (const metrics::Reading& one : readings)
    if (one.name == name) return one.value;
  ADD_FAILURE() << "no " << name;
  return -1;
}

// Of a line "NAME VALUE".
double NotedOf(const std::string& name) {
  const std::string text = metrics::TextOf({});
  const std::size_t at = text.find("\n" + name + " ");
  if (at == std::string::npos) ADD_FAILURE() << "no " << name;
  return at == std::string::npos ? -1 : std::stod(text.substr(at + 1 + name.size()));
}

class FiguresTest : public ServiceTest {};

TEST_F(FiguresTest, NothingWaitsAtRestAndLimitsAreTold) {
  const auto readings = server_->Readings();
  EXPECT_EQ(FigureOf(readings, "rigcal_intake_waiting_bytes"), 0);
  EXPECT_EQ(FigureOf(readings, "rigcal_sessions_open"), 0);
  EXPECT_EQ(FigureOf(readings, "rigcal_questions_waiting"), 0);
  EXPECT_GT(FigureOf(readings, "rigcal_intake_limit_bytes"), 0);
  EXPECT_GT(FigureOf(readings, "rigcal_sessions_open_limit"), 0);
}

TEST_F(FiguresTest, APushIsCountedAndLoggedWithItsIds) {
  const std::string closed = R"(rigcal_receipts_total{state="closed"})",
                    received = R"(rigcal_stage_duration_seconds_count{stage="receive"})";
  const double closed_before = NotedOf(closed), bytes_before = NotedOf("rigcal_received_bytes_total"),
               received_before = NotedOf(received);
  const Session session = MakeSession("mapper-01", {1'000, 250'000, 1}, 1);
  SetLogForm(LogForm::kJson);
  testing::internal::CaptureStderr();
  {
    Client client = MakeClient("mapper-01");
    static_cast<void>(client.Push(session));
  }
  const std::string log = testing::internal::GetCapturedStderr();
  SetLogForm(LogForm::kText);
  EXPECT_GE(NotedOf(closed), closed_before + 1);
  EXPECT_EQ(NotedOf("rigcal_received_bytes_total"), bytes_before + 251'001);
  EXPECT_EQ(NotedOf(received), received_before + 1);
  EXPECT_THAT(log,
              HasSubstr(R"("event":"receipt","robot":"mapper-01","session":")" + session.id.str() + R"(","text":)"));
  EXPECT_EQ(FigureOf(server_->Readings(), "rigcal_sessions_open"), 0) << "it is closed";
}

}  // namespace
}  // namespace rigcal::dds
