#include "client/text/standing_text.h"

#include "client/text/edge_table.h"
#include "client/text/table.h"
#include "server/model/approval/standing.h"

namespace rigcal::client {
namespace {

std::string ShortId(const Document& id) { return id.Text("?").substr(0, 16); }

// "restored by Ada on 2026-02-01T12:00:00Z (the squares were wrong)"
std::string HowText(const Document& standing) {
  const std::string how = standing["how"].Text(), reason = standing["reason"].Text();
  const std::string people = how == "restored" ? "restored by " + standing["who"].Text("?") : "";
  return (people.empty() ? std::string(how == "pushed" ? "pushed" : "pushed again") : people) + " on " +
         standing["at"].Text("?") + (reason.empty() ? "" : " (" + reason + ")");
}

std::string TakeBack(const Document& session) { return " `rigcal restore " + ShortId(session) + "` takes that back."; }

std::string SupersededText(const Document& session) {
  const Document by = session["superseded_by"];
  const std::string people = by["operator"].Text().empty() ? "" : ", by " + by["operator"].Text();
  return "Session " + ShortId(session["session"]) + " does not count: session " + ShortId(by["session"]) +
         " of the same pictures (captured " + by["captured_at"].Text("?") + people + "), " + HowText(by["standing"]) +
         ", supersedes it." + TakeBack(session["session"]);
}

std::string CurrentText(const Document& session) {
  const Document standing = session["standing"];
  std::string text = "Session " + ShortId(session["session"]) + " is current";
  if (standing["how"].Text() != "pushed") text += " again, " + HowText(standing);
  const auto others = session["supersedes"].Items();
  if (others.empty()) return text + ".";
  text += "; superseded by it: session";
  for (const Document& other : others) text += " " + ShortId(other);
  return text + "." + TakeBack(others.front());
}

// A time that cannot be read is that of no day.
Word WordOf(const Document& said) {
  return {ParseIso(said["at"].Text()).value_or(Stamp{}), said["who"].Text("?"), said["reason"].Text()};
}

std::string RetiredSessionText(const Document& session) {
  return "Session " + ShortId(session["session"]) + " does not count: it was " +
         RetiredText(WordOf(session["retired"])) + "." + TakeBack(session["session"]);
}

// "Edge 0123456789abcdef of mapper-01, left - right, "
std::string EdgeNamed(const Document& done) {
  return "Edge " + ShortId(done["edge"]["id"]) + " of " + done["robot"].Text("?") + ", " + PairOf(done["edge"]) + ", ";
}

std::string EdgeStandingText(const Document& done) {
  const Document edge = done["edge"], standing = done["standing"];
  if (standing["how"].Text() == "retired")
    return EdgeNamed(done) + "does not count any more: " + RetiredText(WordOf(standing)) + "." + TakeBack(edge["id"]);
  if (IsPast(edge)) return EdgeNamed(done) + "does not count: " + edge["diagnoses"][0]["what"].Text() + ".";
  return EdgeNamed(done) + "counts" + (standing.IsNull() ? "." : " again, " + HowText(standing) + ".");
}

std::string SensorStandingText(const Document& done) {
  const std::string robot = done["robot"].Text("?"), sensor = done["sensor"].Text("?");
  const Document standing = done["standing"];
  if (standing["how"].Text() == "retired")
    return "Sensor " + sensor + " of " + robot + " does not count any more: " + RetiredText(WordOf(standing)) + ". " +
           BringsBack(RestoreCommand(RobotId(robot), SensorId(sensor)));
  return "Sensor " + sensor + " of " + robot + " counts" +
         (standing.IsNull() ? "." : " again, " + HowText(standing) + ".");
}

}  // namespace

bool IsSuperseded(const Document& session) { return !session["superseded_by"].IsNull(); }

bool IsRetired(const Document& session) { return !session["retired"].IsNull(); }

std::string StandingText(const Document& session) {
  if (IsRetired(session)) return Plain(RetiredSessionText(session));
  return Plain(IsSuperseded(session) ? SupersededText(session) : CurrentText(session));
}

void SayStanding(const Document& session, std::ostream& out) {
  if (IsRetired(session) || IsSuperseded(session) || session["supersedes"].size() > 0)
    out << StandingText(session) << std::endl;
}

void PrintStanding(const Document& done, std::ostream& out) {
  if (!done["session"].IsNull())
    out << StandingText(done["session"]) << std::endl;
  else
    out << Plain(done["edge"].IsNull() ? SensorStandingText(done) : EdgeStandingText(done)) << std::endl;
}

std::string RetiredSensorText(const std::string& robot, const Document& gone) {
  const SensorId sensor(gone["sensor"].Text("?"));
  return Plain(RetiredText(RetiredSensor{sensor, WordOf(gone)}) + ". " +
               BringsBack(RestoreCommand(RobotId(robot), sensor)));
}

void SayRetiredSensors(const std::string& robot, const Document& retired_sensors,
                       const std::function<bool(const std::string& sensor)>& concerns, std::ostream& out) {
  for (const Document& gone : retired_sensors.Items())
    if (concerns(gone["sensor"].Text()))
      out << RetiredSensorText(robot, gone) << " Until then what was sent of it does not count." << std::endl;
}

}  // namespace rigcal::client
