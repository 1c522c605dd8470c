#include <algorithm>

#include "client/check/report.h"
#include "client/check/words.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/calib/core/wording.h"
#include "server/model/approval/validity.h"

namespace rigcal::check {
namespace {

using calib::CountText;
using client::Align;
using client::Fixed;
using client::Plain;
using client::Scaled;
using client::Table;

constexpr const char* kIndent = "         ";

std::size_t FilesOfKind(const Findings& findings, SensorKind kind) {
  std::size_t files = 0;
  for (const SensorFiles& one : findings.sensors)
    if (one.kind == kind) files += one.files;
  return files;
}

void PrintHead(const Findings& findings, std::ostream& out) {
  out << findings.robot.str() << ", captured " << DayText(findings.captured_at) << ": "
      << CountText(findings.sensors.size(), "sensor") << ", " << CountText(findings.captures.size(), "capture") << ", "
      << CountText(FilesOfKind(findings, SensorKind::kCamera), "picture") << ", "
      << CountText(FilesOfKind(findings, SensorKind::kLidar), "cloud") << '\n';
}

void PrintVerdict(const Findings& findings, const Judgement& judgement, std::ostream& out) {
  out << "verdict  ";
  if (!findings.refusals.empty())
    out << "A push refuses this folder (" << CountText(findings.refusals.size(), "reason")
        << ", above). Mend that first. Of the rest: ";
  out << Headline(judgement) << '\n';
  for (const Advice& advice : judgement.advice) {
    std::string line = NamesText(advice.of) + ": " + advice.text;
    if (line.back() != '.') line += '.';
    out << kIndent << Plain(line) << '\n';
  }
  for (std::size_t i = 0; i < judgement.remarks.size(); ++i)
    out << (i == 0 ? "files    " : kIndent) << Plain(judgement.remarks[i]) << '\n';
  out << "limits   Judged by the default limits, " << DefaultLimitsText() << ": the server's policy may want more.\n";
}

// Largest tilt to each side, whole degrees; of no pose "-".
std::string TiltsText(const CameraFound& camera) {
  if (!camera.distances) return "-";
  std::string text;
  for (const double tilt_rad : camera.ring.largest_rad)
    text += (text.empty() ? "" : " ") + Scaled(tilt_rad, client::kDegPerRad, 0);
  return text;
}

std::string LensText(const CameraFound& camera) {
  if (camera.lens_problem) return "not known";
  if (!camera.estimates_lens) return "given";
  return camera.focal_sigma_ratio ? "focal +-" + Scaled(camera.focal_sigma_ratio, 100, 2) + " %" : "estimated";
}

void PrintCameras(const Findings& findings, std::ostream& out) {
  Table table({{"CAMERA"},
               {"pictures", Align::kRight},
               {"board in", Align::kRight},
               {"corners", Align::kRight},
               {"covered %", Align::kRight},
               {"nothing near"},
               {"tilts l r u d deg", Align::kRight},
               {"board widths away", Align::kRight},
               {"edge px", Align::kRight},
               {"blurred", Align::kRight},
               {"lens"}});
  for (const SensorFiles& files : findings.sensors) {
    const auto camera = findings.cameras.find(files.sensor);
    if (camera == findings.cameras.end()) continue;
    const CameraFound& found = camera->second;
    const auto& away = found.distances;
    table.Add({files.sensor.str(), std::to_string(files.files), std::to_string(found.with_board.size()),
               std::to_string(found.corners), Fixed(100 * found.coverage.share_ratio, 0),
               Enumerated(EmptySides(found.coverage)), TiltsText(found),
               away ? Fixed(away->near_widths, 1) + " to " + Fixed(away->far_widths, 1) : "-", Fixed(found.edge_px, 1),
               std::to_string(found.blurred.size()), LensText(found)});
  }
  if (table.empty()) return;
  out << "\nCameras\n";
  table.Print(out);
}

void PrintLidars(const Findings& findings, std::ostream& out) {
  Table table({{"LIDAR"}, {"clouds", Align::kRight}, {"readable", Align::kRight}, {"points", Align::kRight}});
  for (const LidarFound& lidar : findings.lidars)
    table.Add(
        {lidar.lidar.str(), std::to_string(FilesOf(findings, lidar.lidar)->files), std::to_string(lidar.clouds),
         lidar.clouds == 0 ? "-" : std::to_string(lidar.points_least) + " to " + std::to_string(lidar.points_most)});
  if (table.empty()) return;
  out << "\nLidars\n";
  table.Print(out);
}

void PrintPoses(const Findings& findings, std::ostream& out) {
  Table table({{"POSES"}, {"rows", Align::kRight}, {"seconds", Align::kRight}, {"longest gap s", Align::kRight}});
  for (const SensorFiles& files : findings.sensors) {
    if (files.kind != SensorKind::kTracker && files.kind != SensorKind::kPoseStream) continue;
    const auto stream = std::find_if(findings.streams.begin(), findings.streams.end(),
                                     [&](const StreamFound& one) { return one.stream == files.sensor; });
    const bool is_stream = stream != findings.streams.end();
    table.Add({files.sensor.str(), std::to_string(files.usable), is_stream ? Fixed(stream->seconds, 1) : "",
               is_stream ? Fixed(stream->longest_gap_s, 2) : ""});
  }
  if (table.empty()) return;
  out << "\nPoses\n";
  table.Print(out);
}

// Of the least certain axis.
std::string SigmaText(const PairFound& pair, int first_axis, double scale, int digits) {
  if (!pair.edge || pair.edge->state == EdgeState::kFailed) return "";
  double largest = 0;
  for (int axis = first_axis; axis < first_axis + 3; ++axis) {
    const AxisSigma sigma = SigmaOf(pair.edge->uncertainty, axis);
    if (!sigma.known) return "open";
    largest = std::max(largest, sigma.value);
  }
  return Fixed(scale * largest, digits);
}

std::string StateText(const PairFound& pair) {
  if (pair.problem || (pair.edge && pair.edge->state == EdgeState::kFailed)) return "FAILS";
  return pair.edge ? "good" : "counted only";
}

// Whether a sensor whose files are lacking has this for want of them: its captures are few, or a board is not found in
// captures of which it has no picture, as every picture that there is shows one.
bool IsForWantOfFiles(const Findings& findings, const SensorId& sensor, const Diagnosis& diagnosis) {
  if (diagnosis.code.ends_with("few_captures")) return true;
  const auto camera = findings.cameras.find(sensor);
  const auto files = std::find_if(findings.sensors.begin(), findings.sensors.end(),
                                  [&](const SensorFiles& one) { return one.sensor == sensor; });
  return diagnosis.code == "board_not_found" && diagnosis.what.starts_with(sensor.str() + " ") &&
         camera != findings.cameras.end() && files != findings.sensors.end() &&
         camera->second.with_board.size() >= files->files;
}

// What is wrong with a sensor's files is told by its advice, not by what follows from it in each of its pairs: of files
// that are lacking what is for want of them, of a sensor without an answer all.
bool IsTold(const Findings& findings, const PairFound& pair, const Diagnosis& diagnosis, const Judgement& judgement) {
  return std::any_of(judgement.advice.begin(), judgement.advice.end(), [&](const Advice& advice) {
    if (advice.captures_more > 0 || advice.urgency == Urgency::kRough) return false;
    const auto follows_of = [&](const SensorId& sensor) {
      return std::find(advice.of.begin(), advice.of.end(), sensor.str()) != advice.of.end() &&
             (advice.urgency == Urgency::kNoAnswer || IsForWantOfFiles(findings, sensor, diagnosis));
    };
    return follows_of(pair.pair.a) || follows_of(pair.pair.b);
  });
}

// Each sentence once, with the pairs that it is about.
void PrintSentences(const Findings& findings, const Judgement& judgement, std::ostream& out) {
  std::vector<std::pair<std::string, std::vector<std::string>>> told;
  const auto add = [&](const PairFound& pair, const Diagnosis& diagnosis) {
    if (IsTold(findings, pair, diagnosis, judgement)) return;
    const std::string sentence = SentenceOf(diagnosis);
    auto known = std::find_if(told.begin(), told.end(), [&](const auto& one) { return one.first == sentence; });
    if (known == told.end()) known = told.insert(told.end(), {sentence, {}});
    known->second.push_back(PairText(pair.pair));
  };
  for (const PairFound& pair : findings.pairs) {
    if (pair.problem) add(pair, *pair.problem);
    if (pair.edge)
      for (const Diagnosis& diagnosis : pair.edge->diagnoses) add(pair, diagnosis);
  }
  for (const auto& [sentence, pairs] : told) out << NamesText(pairs) << ":\n  " << Plain(sentence) << '\n';
}

void PrintPairs(const Findings& findings, const Judgement& judgement, std::ostream& out) {
  Table table({{"A"},
               {"B"},
               {"METHOD"},
               {"captures", Align::kRight},
               {"enough", Align::kRight},
               {"sigma mm", Align::kRight},
               {"sigma deg", Align::kRight},
               {""}});
  for (const PairFound& pair : findings.pairs) {
    const bool by_captures = pair.needed.enough > 0;
    table.Add({pair.pair.a.str(), pair.pair.b.str(), rigcal::NameOf(pair.method),
               by_captures ? std::to_string(pair.both) : "", by_captures ? std::to_string(pair.needed.enough) : "",
               SigmaText(pair, 0, client::kMmPerM, 2), SigmaText(pair, 3, client::kDegPerRad, 3), StateText(pair)});
  }
  if (table.empty()) return;
  out << "\nPairs, as the server will find them\n";
  table.Print(out);
  PrintSentences(findings, judgement, out);
}

}  // namespace

void PrintReport(const Findings& findings, const Judgement& judgement, std::ostream& out) {
  PrintHead(findings, out);
  PrintVerdict(findings, judgement, out);
  PrintCameras(findings, out);
  PrintLidars(findings, out);
  PrintPoses(findings, out);
  PrintPairs(findings, judgement, out);
}

}  // namespace rigcal::check
