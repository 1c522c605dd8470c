#include "client/record/topic_report.h"

#include <algorithm>

#include "client/text/progress.h"
#include "client/text/table.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::recording {
namespace {

using client::Fixed;
using formats::JsonWriter;

constexpr double kSPerNs = 1e-9;

std::optional<double> InSeconds(std::optional<std::int64_t> ns) {
  return ns ? std::optional(static_cast<double>(*ns) * kSPerNs) : std::nullopt;
}

std::string WordsOf(TopicState state) {
  switch (state) {
    case TopicState::kRecorded:
      return "recorded";
    case TopicState::kNobody:
      return "nobody publishes it";
    case TopicState::kOtherType:
      return "of another type";
    case TopicState::kSilent:
      return "nothing is sent";
    case TopicState::kStalled:
      return "nothing of late";
    case TopicState::kEnded:
      return "its publisher ended";
  }
  return "-";
}

std::string SensorsText(const TopicSeen& seen) {
  std::string text;
  for (const std::string& sensor : seen.topic.sensors) text += (text.empty() ? "" : " ") + sensor;
  return text.empty() ? "-" : text;
}

void WriteRate(JsonWriter& out, const char* key, std::optional<double> rate_hz) {
  rate_hz ? out.Number(key, *rate_hz) : out.Null(key);
}

void WriteTopic(JsonWriter& out, const TopicSeen& seen) {
  const Arrivals& arrivals = seen.arrivals;
  out.Text("topic", seen.topic.name);
  out.List("sensors", [&] {
    for (const std::string& sensor : seen.topic.sensors) out.Text(sensor);
  });
  out.List("types", [&] {
    for (const std::string& type : seen.types) out.Text(type);
  });
  out.Text("state", NameOf(seen.state));
  out.Integer("publishers", static_cast<std::int64_t>(seen.publishers));
  out.Flag("best_effort", seen.best_effort);
  out.Integer("messages", arrivals.messages());
  out.Integer("bytes", arrivals.bytes());
  WriteRate(out, "rate_hz", arrivals.Rate_hz());
  WriteRate(out, "recent_rate_hz", arrivals.RecentRate_hz(seen.at_ns));
  out.Integer("longest_gap_ns", arrivals.LongestGap_ns());
  const auto since_ns = arrivals.SinceLast_ns(seen.at_ns);
  since_ns ? out.Integer("since_last_ns", *since_ns) : out.Null("since_last_ns");
  out.Integer("missed", arrivals.missed());
  out.Integer("unwritten", seen.unwritten);
}

void WriteTopics(JsonWriter& out, const std::vector<TopicSeen>& topics) {
  out.List("topics", [&] {
    for (const TopicSeen& seen : topics) out.Object([&] { WriteTopic(out, seen); });
  });
}

void PrintMissing(const TopicSeen& seen, std::ostream& out) {
  const std::string name = client::Plain(NameFor(seen.topic));
  if (seen.arrivals.messages() == 0 && !seen.topic.IsOptional())
    out << name << ": nothing was recorded: " << WordsOf(seen.state) << ".\n";
  if (seen.arrivals.missed() > 0)
    out << name << ": " << seen.arrivals.missed()
        << " messages were lost on the way, by the numbers that publishers give them.\n";
  if (seen.unwritten > 0)
    out << name << ": " << seen.unwritten << " messages came and were dropped, as the disk did not keep up.\n";
}

}  // namespace

bool RecordingOutcome::IsWhole() const {
  return !ended_early && totals.unwritten == 0 && std::all_of(topics.begin(), topics.end(), [](const TopicSeen& seen) {
    return seen.IsWhole() && (seen.topic.IsOptional() || seen.arrivals.messages() > 0);
  });
}

const char* NameOf(TopicState state) {
  switch (state) {
    case TopicState::kRecorded:
      return "recorded";
    case TopicState::kNobody:
      return "nobody_publishes";
    case TopicState::kOtherType:
      return "other_type";
    case TopicState::kSilent:
      return "silent";
    case TopicState::kStalled:
      return "stalled";
    case TopicState::kEnded:
      return "ended";
  }
  return "";
}

void PrintTopics(const std::vector<TopicSeen>& topics, std::ostream& out) {
  using client::Align;
  client::Table table({{"topic"},
                       {"sensor"},
                       {"state"},
                       {"messages", Align::kRight},
                       {"Hz", Align::kRight},
                       {"Hz now", Align::kRight},
                       {"longest gap [s]", Align::kRight},
                       {"last [s ago]", Align::kRight},
                       {"lost", Align::kRight}});
  for (const TopicSeen& seen : topics) {
    const Arrivals& arrivals = seen.arrivals;
    table.Add({seen.topic.name, SensorsText(seen), WordsOf(seen.state), std::to_string(arrivals.messages()),
               Fixed(arrivals.Rate_hz(), 2), Fixed(arrivals.RecentRate_hz(seen.at_ns), 1),
               arrivals.messages() > 1 ? Fixed(InSeconds(arrivals.LongestGap_ns()), 2) : "-",
               Fixed(InSeconds(arrivals.SinceLast_ns(seen.at_ns)), 1),
               std::to_string(arrivals.missed() + seen.unwritten)});
  }
  table.Print(out);
}

void PrintRecording(const RecordingOutcome& outcome, std::ostream& out) {
  PrintTopics(outcome.topics, out);
  out << outcome.totals.messages << " messages in "
      << client::DurationText(static_cast<double>(outcome.elapsed_ns) * kSPerNs) << ", "
      << client::ByteText(static_cast<double>(outcome.totals.bytes)) << ": " << outcome.bag.string() << '\n';
  for (const TopicSeen& seen : outcome.topics) PrintMissing(seen, out);
  if (outcome.totals.unwritten > 0)
    out << outcome.totals.unwritten << " messages that came last are not in the bag: the disk failed.\n";
}

std::string ProgressJson(std::int64_t elapsed_ns, const std::vector<TopicSeen>& topics) {
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("kind", "progress");
    out.Integer("elapsed_ns", elapsed_ns);
    WriteTopics(out, topics);
  });
}

std::string RecordingJson(const RecordingOutcome& outcome) {
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("kind", "recorded");
    out.Text("bag", outcome.bag.string());
    out.Integer("elapsed_ns", outcome.elapsed_ns);
    out.Integer("messages", static_cast<std::int64_t>(outcome.totals.messages));
    out.Integer("bytes", static_cast<std::int64_t>(outcome.totals.bytes));
    out.Integer("unwritten", static_cast<std::int64_t>(outcome.totals.unwritten));
    out.Flag("whole", outcome.IsWhole());
    WriteTopics(out, outcome.topics);
  });
}

void LiveTable::Clear() {
  if (lines_ > 0) err_ << "\x1b[" << lines_ << "A\r\x1b[J" << std::flush;
  lines_ = 0;
}

void LiveTable::Show(const std::string& text) {
  Clear();
  err_ << text << std::flush;
  lines_ = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

void LiveTable::Say(const std::string& sentence) {
  Clear();
  err_ << sentence << std::endl;
}

}  // namespace rigcal::recording
