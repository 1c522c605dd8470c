#include "client/certificate/lines.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "client/text/table.h"
#include "client/verb.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kVerdictLines = 3, kDecisionLines = 2;

// Approved, and not taken back or rejected since.
bool IsCertified(const Document& show) {
  const std::string level = show["document"]["verdict"]["level"].Text(), state = show["state"].Text();
  return (level == "pass" || level == "warn") && (state == "approved" || state == "superseded");
}

std::string TitleOf(const Document& show) {
  return IsCertified(show) ? "Calibration certificate" : "Calibration record, no certificate";
}

// "2026-11-03T12:00:00Z", to the second.
std::string TimeOf(const Document& time) {
  const std::string text = time.Text();
  return text.size() < 19 ? "at a time that is not known" : text.substr(0, 19) + "Z";
}

std::string NameOfRevision(const CertificateDocuments& documents) {
  const Document& show = documents.show;
  std::string name = show["robot"].Text("?");
  const std::string model = documents.sessions.empty() ? "" : documents.sessions[0]["manifest"]["rig_model"].Text();
  if (!model.empty()) name += ", rig model " + model;
  return name + ", revision " + CountOf(show["revision"]);
}

// "approved by Ada, 3 Nov 2026: checked against the wall"
std::string LifeOf(const Document& show) {
  const Document decision = show["decision"];
  if (decision.IsNull()) return "State: " + show["state"].Text("unknown") + ".";
  return "State: " + show["state"].Text("unknown") + ", " + decision["how"].Text() + " by " + decision["who"].Text() +
         ", " + DayOf(decision["at"]) + ": " + decision["reason"].Text() + ".";
}

void AddHead(const CertificateDocuments& documents, std::vector<CertificateLine>& lines) {
  const Document& show = documents.show;
  lines.push_back({TitleOf(show), LineStyle::kTitle});
  lines.push_back({NameOfRevision(documents), LineStyle::kHeading});
  AddText("Measured " + TimeOf(show["calibrated_at"]) + ", solved " + TimeOf(show["created_at"]) + ". " + LifeOf(show),
          kDecisionLines, lines);
  const Document verdict = show["document"]["verdict"];
  AddText(show["drive"]["rule"].Text("-") + ". Verdict " + verdict["level"].Text("unknown") + ": " +
              verdict["why"].Text("-"),
          kVerdictLines, lines);
}

void AddOrigin(const CertificateDocuments& documents, std::vector<CertificateLine>& lines) {
  AddText("Printed by rigcald " + documents.software + ". Document: revision.json, sha256 " +
              documents.show["digest"].Text("-"),
          2, lines);
  if (!IsCertified(documents.show)) return;
  lines.push_back({"", LineStyle::kText});
  lines.push_back(
      {"Place and date ______________________  Name ______________________  Signature ______________________",
       LineStyle::kText});
}

}  // namespace

void AddText(const std::string& text, std::size_t lines_max, std::vector<CertificateLine>& lines) {
  std::istringstream words(Plain(text));
  std::vector<std::string> wrapped;
  for (std::string word, line; words >> word;) {
    const bool fits = !wrapped.empty() && WidthOf(wrapped.back()) + 1 + WidthOf(word) <= kTextColumns;
    if (fits)
      wrapped.back() += " " + word;
    else
      wrapped.push_back((wrapped.empty() ? "" : "  ") + word);
  }
  if (wrapped.size() > lines_max) wrapped.resize(lines_max), wrapped.back() += " [...]";
  for (std::string& line : wrapped) lines.push_back({std::move(line), LineStyle::kText});
}

std::vector<std::string> SessionsCounted(const Document& show) {
  std::set<std::string> counted;
  for (const Document& edge : show["document"]["edges"].Items())
    if (edge["state"].Text() == "good" && !edge["session"].IsNull()) counted.insert(edge["session"].Text());
  return {counted.begin(), counted.end()};
}

std::vector<CertificateLine> CertificateLines(const CertificateDocuments& documents) {
  std::vector<CertificateLine> lines;
  AddHead(documents, lines);
  AddPoses(documents.show, lines);
  AddAsFound(documents.show, lines);
  AddMeasuredWith(documents, lines);
  AddOrigin(documents, lines);
  return lines;
}

}  // namespace rigcal::client
