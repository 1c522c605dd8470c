#include "client/text/recomputation_text.h"

#include "client/text/table.h"
#include "client/verb.h"
#include "server/model/approval/decision.h"

namespace rigcal::client {
namespace {

constexpr double kDegOfRad = 57.29577951308232;

std::int64_t NumberIn(const Document& counts, const char* key) { return counts[key].Integer().value_or(0); }

// "2 sessions", "1 robot".
std::string Counted(std::int64_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

void AddCount(const Document& counts, const char* key, const char* words, std::string& text) {
  if (const std::int64_t count = NumberIn(counts, key); count > 0)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + words;
}

std::string SessionsText(const Document& sessions) {
  std::string how;
  AddCount(sessions, "computed", "computed again", how);
  AddCount(sessions, "same", "computed so before", how);
  AddCount(sessions, "kept", "kept as they are", how);
  AddCount(sessions, "failed", "failed", how);
  const std::int64_t older = NumberIn(sessions, "older");
  return Counted(NumberIn(sessions, "total"), "session") + (how.empty() ? "" : ": " + how) +
         (older > 0 ? "; " + std::to_string(older) + " older, which no calibration is made of, stay as they are" : "");
}

std::string RobotsText(const Document& robots) {
  std::string how;
  for (const char* key : {"changed", "unchanged", "failed"}) AddCount(robots, key, key, how);
  return Counted(NumberIn(robots, "total"), "robot") + (how.empty() ? "" : ": " + how);
}

// Robots are solved anew after their sessions; of those that have edges alone, none is computed.
std::string StandText(const Document& document) {
  const auto stand = [](const Document& counts, const char* things) {
    return std::to_string(NumberIn(counts, "done")) + " of " + std::to_string(NumberIn(counts, "total")) + " " + things;
  };
  const std::string robots = stand(document["robots_count"], "robots");
  const bool has_sessions = NumberIn(document["sessions"], "total") > 0;
  return (has_sessions ? stand(document["sessions"], "sessions") + " and " : "") + robots + " are done";
}

// A list that was cut says so.
void PrintCount(const Document& counts, std::size_t listed, std::ostream& out) {
  const std::int64_t more = NumberIn(counts, "done") - static_cast<std::int64_t>(listed);
  if (listed > 0 && more > 0) out << "and " << Counted(more, "more robot") << ", not listed here\n";
}

void AddRows(const Document& robot, Table& table) {
  const std::string candidate = CountOf(robot["revision"]), against = CountOf(robot["against"]);
  const std::string state = WordFor(RevisionStateOf(robot["state"].Text())), verdict = robot["verdict"].Text("-");
  const std::vector<Document> changes = robot["changes"].Items();
  const std::string name = robot["robot"].Text("?");
  if (changes.empty()) table.Add({name, candidate, against, verdict, state, "(no pose moves)"});
  for (const Document& change : changes) {
    const bool moved = change["how"].Text() == "moved";
    const auto moved_m = change["moved_m"].Number(), turned_rad = change["turned_rad"].Number();
    table.Add({name, candidate, against, verdict, state, change["sensor"].Text("?"),
               moved ? Scaled(moved_m, 1000.0, 2) : change["how"].Text(), moved ? Scaled(turned_rad, kDegOfRad, 3) : "",
               moved ? Fixed(change["sigmas"].Number(), 1) : ""});
  }
}

void PrintChanges(const std::vector<Document>& robots, std::ostream& out) {
  Table table({{"ROBOT"},
               {"REVISION", Align::kRight},
               {"AGAINST", Align::kRight},
               {"VERDICT"},
               {"STATE"},
               {"SENSOR"},
               {"MOVED mm", Align::kRight},
               {"TURNED deg", Align::kRight},
               {"SIGMAS", Align::kRight}});
  bool waits = false;
  for (const Document& robot : robots) {
    if (robot["how"].Text() == "changed") AddRows(robot, table);
    waits = waits || robot["state"].Text() == "candidate";
  }
  if (table.empty()) return;
  table.Print(out);
  if (waits)
    out << "Candidates are used by no robot until a person approves them: `rigcal approve ROBOT REVISION --reason "
           "TEXT`.\n";
}

void PrintUnchanged(const std::vector<Document>& robots, std::ostream& out) {
  std::string names;
  for (const Document& robot : robots)
    if (robot["how"].Text() == "unchanged") names += (names.empty() ? "" : ", ") + robot["robot"].Text("?");
  if (!names.empty()) out << "unchanged: " << Plain(names) << '\n';
  for (const Document& robot : robots)
    if (robot["how"].Text() == "failed")
      out << "robot " << Plain(robot["robot"].Text("?")) << " failed: " << Plain(robot["why"].Text()) << '\n';
}

}  // namespace

std::string RunText(const Document& document) {
  return Plain("Run " + CountOf(document["run"]) + ": " + document["scope_text"].Text("?") + ", " +
               document["cause"].Text("?") + ", asked for by " + document["who"].Text("?") + ".");
}

std::string ChangedText(const Document& document) {
  const Document robots = document["robots_count"];
  const std::string failed =
      NumberIn(robots, "failed") > 0 ? ", " + std::to_string(NumberIn(robots, "failed")) + " failed" : "";
  return Counted(NumberIn(robots, "changed"), "robot") + " changed" + failed;
}

void PrintRecomputation(const Document& document, std::ostream& out) {
  const std::vector<Document> robots = document["robots"].Items();
  out << RunText(document) << '\n';
  out << SessionsText(document["sessions"]) << ". " << RobotsText(document["robots_count"]) << ".\n";
  if (!document["done"].Flag())
    out << "It goes on: " << StandText(document) << ". `rigcal resolve --status` follows it.\n";
  PrintChanges(robots, out);
  PrintUnchanged(robots, out);
  PrintCount(document["robots_count"], robots.size(), out);
  for (const Document& left : document["sessions_left"].Items())
    out << Plain("session " + left["session"].Text("?").substr(0, 16) + " of robot " + left["robot"].Text("?") +
                 (left["how"].Text() == "kept" ? " is kept as it is: " : " failed: ") + left["why"].Text())
        << '\n';
}

}  // namespace rigcal::client
