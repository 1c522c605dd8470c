#include "client/record/topic_report.h"

#include <gmock/gmock.h>

#include <sstream>

namespace rigcal::recording {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kS = 1'000'000'000;

TopicSeen Recorded() {
  TopicSeen seen{{"/left", {"left"}, {bags::MessageKind::kImage}},
                 TopicState::kRecorded,
                 {"sensor_msgs/msg/Image"},
                 1,
                 true,
                 {},
                 12 * kS,
                 0};
  seen.arrivals.BeginWindow(0);
  for (int k = 0; k < 21; ++k) seen.arrivals.Add(k * kS / 2, 1000, 1, k + 1 + (k == 20 ? 3 : 0));
  return seen;
}
TopicSeen Absent() {
  return {{"/right", {"right"}, {bags::MessageKind::kImage}}, TopicState::kNobody, {}, 0, false, {}, 12 * kS, 0};
}
TopicSeen StaticFrames() {
  return {{"/tf_static", {}, {bags::MessageKind::kTransforms}}, TopicState::kNobody, {}, 0, false, {}, 12 * kS, 0};
}

RecordingOutcome Outcome(std::vector<TopicSeen> topics) {
  std::uint64_t messages = 0;
  for (const TopicSeen& seen : topics) messages += static_cast<std::uint64_t>(seen.arrivals.messages());
  return {"visit.mcap", 12 * kS, std::move(topics), {messages, 21'000, 0}, false};
}

std::string TextOf(const RecordingOutcome& outcome) {
  std::ostringstream out;
  PrintRecording(outcome, out);
  return out.str();
}

TEST(TopicReport, TellsRatesAndWhatIsMissing) {
  const RecordingOutcome outcome = Outcome({Recorded(), Absent(), StaticFrames()});
  const std::string text = TextOf(outcome);
  EXPECT_THAT(text, testing::ContainsRegex("/left +left +recorded +21 +2.00 +1.8 +0.50 +2.0 +3\n"));
  EXPECT_THAT(text, testing::ContainsRegex("/right +right +nobody publishes it +0 +- "));
  EXPECT_THAT(text, HasSubstr("21 messages in 12 s, 21 kB: visit.mcap\n"));
  EXPECT_THAT(text, HasSubstr("/left (left): 3 messages were lost on the way"));
  EXPECT_THAT(text, HasSubstr("/right (right): nothing was recorded: nobody publishes it.\n"));
  EXPECT_THAT(text, Not(HasSubstr("/tf_static: nothing"))) << "it need not be there";
  EXPECT_FALSE(outcome.IsWhole());
}

TEST(TopicReport, IsWholeWhereNothingIsMissing) {
  TopicSeen left = Recorded();
  left.arrivals = {};
  left.arrivals.Add(kS, 1, 1, 1);
  RecordingOutcome outcome = Outcome({left, StaticFrames()});
  EXPECT_TRUE(outcome.IsWhole());
  outcome.topics[0].unwritten = 1;
  EXPECT_FALSE(outcome.IsWhole());
  EXPECT_THAT(TextOf(outcome), HasSubstr("1 messages came and were dropped, as the disk did not keep up"));
  outcome.topics[0].unwritten = 0;
  outcome.totals.unwritten = 1;
  EXPECT_FALSE(outcome.IsWhole());
  EXPECT_THAT(TextOf(outcome), HasSubstr("1 messages that came last are not in the bag: the disk failed"));
  outcome.totals.unwritten = 0;
  outcome.ended_early = true;
  EXPECT_FALSE(outcome.IsWhole());
}

TEST(TopicReport, AsJson) {
  const std::string progress = ProgressJson(7, {Recorded(), Absent()}),
                    recorded = RecordingJson(Outcome({Recorded(), Absent()}));
  EXPECT_THAT(progress, HasSubstr(R"("elapsed_ns":7,"kind":"progress")"));
  for (const std::string& text : {progress, recorded}) {
    EXPECT_THAT(
        text,
        HasSubstr(
            R"("best_effort":true,"bytes":21000,"longest_gap_ns":500000000,"messages":21,"missed":3,"publishers":1,"rate_hz":2.0,)"));
    EXPECT_THAT(
        text,
        HasSubstr(
            R"("since_last_ns":2000000000,"state":"recorded","topic":"/left","types":["sensor_msgs/msg/Image"],"unwritten":0)"));
    EXPECT_THAT(text, HasSubstr(R"("rate_hz":null)")) << "of what never came";
    EXPECT_THAT(text, HasSubstr(R"("state":"nobody_publishes")"));
  }
  EXPECT_THAT(recorded, HasSubstr(R"("bag":"visit.mcap")"));
  EXPECT_THAT(recorded, HasSubstr(R"("whole":false)"));
}

// A sentence stays, the table is in its place again below it, and nothing of it is left.
TEST(LiveTable, RedrawsItsLinesAlone) {
  std::ostringstream out;
  {
    LiveTable table(out);
    table.Show("a\nb\n");
    table.Say("sentence");
    table.Show("c\n");
  }
  EXPECT_EQ(out.str(), "a\nb\n\x1b[2A\r\x1b[Jsentence\nc\n\x1b[1A\r\x1b[J");
}

}  // namespace
}  // namespace rigcal::recording
