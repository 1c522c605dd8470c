#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "server/report/boards/board_remarks.h"
#include "server/report/frame/assets.h"
#include "server/report/frame/page.h"
#include "server/report/frame/retired_section.h"
#include "server/report/pages/session_sheet.h"
#include "server/report/robot_pages.h"
#include "server/report/text/figure_words.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

std::vector<const Edge*> Sorted(const std::vector<Edge>& edges) {
  std::vector<const Edge*> sorted;
  for (const Edge& edge : edges) sorted.push_back(&edge);
  std::sort(sorted.begin(), sorted.end(), [](const Edge* x, const Edge* y) {
    const auto key = [](const Edge* edge) {
      return std::make_tuple(edge->state != EdgeState::kFailed, edge->frame_a, edge->frame_b, edge->id);
    };
    return key(x) < key(y);
  });
  return sorted;
}

void FillPast(Dictionary& row, const Diagnosis& past) {
  row.SetValue("LEVEL", "unknown");
  row.SetValue("STATE", "past");
  row.SetValue("WHY", past.what);
  ShowValue(row, "CURE", "TEXT", past.cure);
}

bool IsRobotWell(const std::optional<RobotSummary>& robot) {
  return !robot || DriveRuleOf(robot->verdict, robot->validity, robot->runs).level == VerdictLevel::kPass;
}

// Green is for pairs of a robot that is well: of one that is not, a pair may be good by itself and what it fails by.
void FillEdge(Dictionary& row, const Edge& edge, const std::map<EdgeId, Diagnosis>& past, bool is_robot_well) {
  const bool good = edge.state == EdgeState::kGood;
  row.SetValue("FROM", edge.frame_a.str());
  row.SetValue("TO", edge.frame_b.str());
  row.SetValue("METHOD", MethodText(edge));
  if (const auto why = past.find(edge.id); why != past.end()) return FillPast(row, why->second);
  FillRetire(row, RetireCommand(edge.id));
  row.SetValue("LEVEL", !good ? "fail" : !edge.diagnoses.empty() ? "warn" : is_robot_well ? "pass" : "unknown");
  row.SetValue("STATE", !good ? "failed" : edge.diagnoses.empty() ? "good" : "good, but");
  if (edge.diagnoses.empty()) return;
  row.SetValue("WHY", edge.diagnoses.front().what);
  if (!edge.diagnoses.front().cure.empty()) ShowValue(row, "CURE", "TEXT", edge.diagnoses.front().cure);
}

void FillEdges(Dictionary& page, const SessionInput& input) {
  const std::vector<Edge>& edges = input.edges;
  if (edges.empty()) return page.ShowSection(input.row.closed && input.row.pairs == 0 ? "NO_PAIRS" : "NO_EDGES");
  Dictionary* list = page.AddSectionDictionary("EDGES");
  const std::vector<const Edge*> sorted = Sorted(edges);
  if (sorted.front()->state == EdgeState::kFailed) page.ShowSection("FAILED_FIRST");
  for (const Edge* edge : sorted)
    FillEdge(*list->AddSectionDictionary("EDGE"), *edge, input.past, IsRobotWell(input.robot_now));
}

// What to do is what most of the failed pairs ask for; of equally many, the first by the alphabet. Nothing is asked for
// what is past.
std::string CommonestCure(const SessionInput& input) {
  std::map<std::string, int> cures;
  for (const Edge& edge : input.edges)
    if (edge.state == EdgeState::kFailed && !edge.diagnoses.empty() && !input.past.contains(edge.id))
      ++cures[edge.diagnoses.front().cure];
  const auto most =
      std::max_element(cures.begin(), cures.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == cures.end() ? "" : most->first;
}

// "5 pictures of front_right cannot be read": what fails first of all.
std::string UnreadableText(const SessionInput& input) {
  std::set<SensorId> sensors;
  for (const auto& [place, why] : input.unreadable) sensors.insert(place.second);
  if (sensors.empty()) return "";
  std::string names;
  for (const SensorId& sensor : sensors) names += (names.empty() ? "" : ", ") + sensor.str();
  return (input.all_looked_at ? " " : " At least ") + Count(input.unreadable.size(), "picture", "pictures") + " of " +
         names + " cannot be read.";
}

// A visit whose pairs are all good may be what its robot fails by. Whether this is so of the newest revision, or
// whether the visit counts in it at all, is for the robot's page to say: here is its rule and its cause.
void FillRobotNow(Dictionary& page, const std::optional<RobotSummary>& robot) {
  if (!robot || robot->revision == 0) return;
  const DriveRule drive = DriveRuleOf(robot->verdict, robot->validity, robot->runs);
  Dictionary* now = page.AddSectionDictionary("ROBOT_NOW");
  now->SetValue("LEVEL", NameOf(drive.level));
  now->SetValue("RULE", drive.rule + ".");
  now->SetValue("NUMBER", std::to_string(robot->revision));
  const std::vector<VerdictReason>& reasons = robot->basis.reasons;  // its report has the others
  if (drive.level != VerdictLevel::kPass)
    ShowValue(*now, "WHY", "TEXT", reasons.empty() ? robot->verdict.why : reasons.front().why);
}

struct Outcome {
  std::string level, sentence, cure;
};

Outcome SupersededOutcome(const SessionRow& row) {
  const Superseding& by = *row.superseded_by;
  const std::string people = by.operator_name.empty() ? "" : ", by " + by.operator_name;
  return {"under-way",
          "This session does not count: session " + ShortDigest(by.by.str()) + " of the same pictures (captured " +
              TimeText(by.captured_at) + people + "), " + HowText(by.standing) + " on " +
              TimeText(by.standing.word.at) + ", supersedes it.",
          "Nothing, if that is the right one; else `rigcal restore " + row.id.str().substr(0, 16) + "` takes it back."};
}

Outcome RetiredOutcome(const SessionRow& row) {
  return {"under-way", "This session does not count: it was " + RetiredText(*row.retired) + ".",
          BringsBack(RestoreCommand(row.id))};
}

Outcome OutcomeOf(const SessionInput& input) {
  const SessionRow& row = input.row;
  const std::string pairs = Count(static_cast<std::size_t>(row.pairs), "pair", "pairs");
  if (!row.closed)
    return {"under-way",
            "This session is arriving, or its push broke off: " + std::to_string(row.files_held) + " of " +
                std::to_string(row.files) + " files are here.",
            "Wait a moment; if nothing changes, push it again: what is here already is not sent twice."};
  if (row.pairs_waiting > 0)
    return {"under-way",
            "This session is being calibrated: " + std::to_string(row.pairs - row.pairs_waiting) + " of " + pairs +
                " are done.",
            ""};
  if (row.retired) return RetiredOutcome(row);
  if (row.superseded_by) return SupersededOutcome(row);
  if (row.pairs == 0)
    return {"warn", "This session has no pair of sensors that could be calibrated.",
            "Name at least two sensors in session.yaml that see one target, or that move together."};
  const std::string unreadable = UnreadableText(input);
  if (row.failed == 0)
    return {"still",
            (row.pairs == 1 ? "The pair of sensors was" : "All " + pairs + " of sensors were") +
                std::string(" calibrated.") + unreadable,
            ""};
  const std::string cure = CommonestCure(input);
  const std::string first = unreadable.empty() ? cure : "Save or copy anew the pictures that cannot be read. " + cure;
  if (row.good == 0)
    return {"off",
            (row.pairs == 1 ? "The pair of sensors could not" : "None of " + pairs + " of sensors could") +
                std::string(" be calibrated.") + unreadable,
            first};
  return {"warn",
          std::to_string(row.good) + " of " + pairs + " of sensors were calibrated, " + std::to_string(row.failed) +
              " failed." + unreadable,
          first};
}

void FillOutcome(Dictionary& page, const SessionInput& input) {
  const Outcome outcome = OutcomeOf(input);
  // Green is for the whole of it.
  page.SetValue("OUTCOME_LEVEL",
                outcome.level == "still" && !IsRobotWell(input.robot_now) ? "under-way" : outcome.level);
  page.SetValue("OUTCOME", outcome.sentence);
  if (!outcome.cure.empty()) ShowValue(page, "DO", "WHAT_TO_DO", outcome.cure);
  const SessionRow& row = input.row;
  const bool arriving = !row.closed;
  if (!arriving && row.pairs_waiting == 0) return;
  page.ShowSection("LIVE");
  Dictionary* progress = page.AddSectionDictionary("PROGRESS");
  progress->SetValue("DONE", std::to_string(arriving ? row.files_held : row.pairs - row.pairs_waiting));
  progress->SetValue("ALL", std::to_string(arriving ? row.files : row.pairs));
}

void FillFacts(Dictionary& page, const SessionInput& input) {
  page.SetValue("TIME", TimeText(input.row.captured_at));
  page.SetValue("FILES", std::to_string(input.row.files_held) + " of " +
                             Count(static_cast<std::size_t>(input.row.files), "file", "files"));
  if (!input.row.operator_name.empty()) ShowValue(page, "OPERATOR", "NAME", input.row.operator_name);
  for (const auto& [name, value] : input.manifest.header.conditions) {
    Dictionary* condition = page.AddSectionDictionary("CONDITION");
    condition->SetValue("NAME", name);
    condition->SetValue("VALUE", value);
  }
}

// Serial numbers and firmware, as far as the session tells them.
void FillPartsOfSensors(Dictionary& page, const SessionHeader& header) {
  for (const Sensor& sensor : header.sensors) {
    if (sensor.serial.empty() && sensor.firmware.empty()) continue;
    Dictionary* part = page.AddSectionDictionary("PART_OF");
    part->SetValue("NAME", sensor.id.str());
    if (!sensor.serial.empty()) ShowValue(*part, "SERIAL", "TEXT", sensor.serial);
    if (!sensor.firmware.empty()) ShowValue(*part, "FIRMWARE", "TEXT", sensor.firmware);
  }
}

}  // namespace

Result<std::string> RenderSession(const SessionInput& input) {
  Dictionary page("session");
  const std::string short_id = ShortDigest(input.row.id.str());
  FillHead(page, input.robot.str() + ", session " + short_id, "../../../../");
  page.SetValue("ROBOT", input.robot.str());
  page.SetValue("SHORT", short_id);
  page.SetValue("ID", input.row.id.str());
  FillFacts(page, input);
  FillOutcome(page, input);
  FillRobotNow(page, input.robot_now);
  FillGone(page, input.robot, input.retired);
  if (!input.lacking.empty()) ShowValue(page, "LACKING", "TEXT", input.lacking);
  FillPartsOfSensors(page, input.manifest.header);
  FillBoardRemarks(page, input.board_remarks);
  if (input.row.closed && !input.row.retired) ShowValue(page, "MISLEADS", "COMMAND", RetireCommand(input.row.id));
  FillEdges(page, input);
  FillSheet(page, input);
  AddScript(page, "../../../../" + AssetPath("live.js"));
  return Expand("session.tpl", page);
}

}  // namespace rigcal::report
