#include "client/standing_text.h"

#include "client/table.h"

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

}  // namespace

bool IsSuperseded(const Document& session) { return !session["superseded_by"].IsNull(); }

std::string StandingText(const Document& session) {
  return Plain(IsSuperseded(session) ? SupersededText(session) : CurrentText(session));
}

void SayStanding(const Document& session, std::ostream& out) {
  if (IsSuperseded(session) || session["supersedes"].size() > 0) out << StandingText(session) << std::endl;
}

}  // namespace rigcal::client
