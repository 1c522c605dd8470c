#include <cmath>

#include "client/import/report.h"
#include "client/text/table.h"
#include "server/base/stamp.h"

namespace rigcal::importing {
namespace {

using client::Fixed;

// From here on a clock is told to differ: a driver's and a recorder's on one machine are nearer.
constexpr std::int64_t kOffsetTold_ns = 100'000'000;
constexpr double kGapsTold = 3.0;  // times the usual time between two messages
constexpr double kSpread_ms = 1e-6;

std::string SecondsText(std::int64_t ns) { return Fixed(static_cast<double>(ns) * 1e-9, 3); }

std::string OffsetText(const TopicSurvey& topic) {
  if (!topic.stamp_offset) return "-";
  return Fixed(static_cast<double>(topic.stamp_offset->median_ns) * kSpread_ms, 1);
}

void PrintTable(const BagSurvey& survey, std::ostream& out) {
  using client::Align;
  client::Table table({{"topic"},
                       {"type"},
                       {"sensor"},
                       {"messages", Align::kRight},
                       {"Hz", Align::kRight},
                       {"longest gap [s]", Align::kRight},
                       {"stamp - log [ms]", Align::kRight},
                       {"what"}});
  for (const TopicSurvey& topic : survey.topics)
    table.Add({topic.name, topic.type, topic.sensor_kind.empty() ? "-" : topic.sensor_kind, std::to_string(topic.count),
               Fixed(topic.rate_hz, 2), topic.count > 1 ? SecondsText(topic.longest_gap_ns) : "-", OffsetText(topic),
               topic.detail});
  if (!table.empty()) table.Print(out);
}

void PrintClock(const TopicSurvey& topic, std::ostream& out) {
  if (topic.count > 0 && topic.unset_stamps > 0)
    out << client::Plain(topic.name) << ": " << topic.unset_stamps << " of " << topic.count
        << " headers have no time. `stamp: log` in rig.yaml takes the recorder's.\n";
  else if (topic.stamp_offset &&
           std::abs(static_cast<double>(topic.stamp_offset->median_ns)) > static_cast<double>(kOffsetTold_ns))
    out << client::Plain(topic.name) << ": its stamps are " << SecondsText(topic.stamp_offset->median_ns)
        << " s off the recorder's clock (" << SecondsText(topic.stamp_offset->min_ns) << " to "
        << SecondsText(topic.stamp_offset->max_ns) << "). Sensors on different clocks make no captures.\n";
  if (topic.backward_stamps > topic.unset_stamps)
    out << client::Plain(topic.name) << ": " << topic.backward_stamps << " stamps are not later than the one before.\n";
}

void PrintGap(const TopicSurvey& topic, std::ostream& out) {
  if (!topic.rate_hz || topic.count < 5 ||
      static_cast<double>(topic.longest_gap_ns) * 1e-9 * *topic.rate_hz < kGapsTold)
    return;
  out << client::Plain(topic.name) << ": nothing for " << SecondsText(topic.longest_gap_ns) << " s from "
      << ToIso(Stamp{topic.gap_at_ns}) << " on.\n";
}

std::string CountText(std::size_t count, const std::string& what) {
  return count == 0 ? "" : ", " + std::to_string(count) + " " + what;
}

void PrintSensor(const SensorOutcome& sensor, std::ostream& out) {
  out << sensor.id << ": " << sensor.written << " of " << sensor.messages << " messages of "
      << client::Plain(sensor.topic) << " written"
      << CountText(sensor.use.without_partner, "without a partner within the tolerance")
      << CountText(sensor.use.left_out, "in moments that are no capture")
      << CountText(sensor.use.thinned_out, "too soon after another capture")
      << CountText(sensor.use.repeated_stamp + static_cast<std::size_t>(sensor.repeated_stamps),
                   "with the stamp of another one")
      << CountText(static_cast<std::size_t>(sensor.refused), "refused") << ".\n";
  if (sensor.refused > 0) out << "  the first refused: " << client::Plain(sensor.first_refusal) << '\n';
  if (!sensor.camera_change.empty())
    out << "  " << client::Plain(sensor.camera_change)
        << ". Pictures of before and after are of two lenses, and are calibrated as one: split the bag there.\n";
}

void PrintMoments(const MomentsTold& told, std::ostream& out) {
  out << MomentsText(told) << '\n';
  if (const std::string clocks = ClocksText(told); !clocks.empty()) out << "Clocks: " << clocks << ".\n";
}

}  // namespace

void PrintSurvey(const BagSurvey& survey, std::ostream& out) {
  PrintTable(survey, out);
  out << survey.messages << " messages of " << survey.topics.size() << " topics";
  if (survey.messages > 0)
    out << ", from " << ToIso(Stamp{survey.first_ns}) << " on, " << SecondsText(survey.last_ns - survey.first_ns)
        << " s";
  out << ".\n";
  for (const TopicSurvey& topic : survey.topics) {
    if (!topic.sensor_kind.empty()) PrintClock(topic, out);
    if (!topic.sensor_kind.empty()) PrintGap(topic, out);
    if (!topic.camera_change.empty()) out << client::Plain(topic.name) << ' ' << topic.camera_change << ".\n";
    if (!topic.trouble.empty()) out << "Not decoded: " << client::Plain(topic.trouble) << '\n';
  }
}

void PrintOutcome(const ImportOutcome& outcome, const std::string& folder, std::ostream& out) {
  if (outcome.was_complete) out << folder << " holds this import already, whole.\n";
  if (outcome.was_complete && outcome.sensors.empty()) return;
  out << folder << ": " << outcome.captures << " captures of ";
  if (outcome.moments)
    out << "still moments";
  else
    out << "messages within " << Fixed(static_cast<double>(outcome.tolerance_ns) * kSpread_ms, 1) << " ms";
  if (outcome.kept_files > 0) out << "; " << outcome.kept_files << " files were there already";
  out << ".\n";
  if (outcome.moments) PrintMoments(*outcome.moments, out);
  if (outcome.shows_no_board)
    out << "Its cameras run freely and no picture shows a board: nothing tells what stood still, so that it was taken "
           "by its stamps alone.\n";
  for (const SensorOutcome& sensor : outcome.sensors) PrintSensor(sensor, out);
}

}  // namespace rigcal::importing
