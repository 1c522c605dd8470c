#include "client/text/edge_table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/model/edges/past.h"

namespace rigcal::client {
namespace {

// A polished pose is not the plain method's.
std::string MethodOf(const Document& edge) {
  return edge["method"].Text("-") + (edge["figures"]["polished_ratio"].Number().value_or(0.0) > 0.0 ? "+gicp" : "");
}

void AddRow(const Document& edge, EdgeIds ids, Table& table) {
  const Document e = edge["residual"]["e"];
  std::vector<std::string> cells = {edge["frame_a"].Text("?"),
                                    edge["frame_b"].Text("?"),
                                    MethodOf(edge),
                                    Triple(edge["T_a_b"]["p_m"], kMmPerM, 2),
                                    RpyText(edge["T_a_b"], 3),
                                    Triple(edge["sigma_m"], kMmPerM, 3),
                                    Triple(edge["sigma_rad"], kDegPerRad, 4),
                                    Scaled(LengthOf(e, 0), kMmPerM, 3),
                                    Scaled(LengthOf(e, 3), kDegPerRad, 4)};
  if (ids == EdgeIds::kShown) cells.insert(cells.begin(), edge["id"].Text("?").substr(0, 12));
  table.Add(std::move(cells));
}

std::string PartsText(const Document& error) {
  std::array<char, 96> text{};
  const auto number = [&](const char* key) { return error[key].Number().value_or(0.0); };
  std::snprintf(text.data(), text.size(), "%.4g (%.4g m^2 + %.4g rad^2)", number("total"), number("translation_m2"),
                number("rotation_rad2"));
  return text.data();
}

std::string SentenceOf(const Document& diagnosis, Cures cures = Cures::kTold) {
  return Sentence({ErrorCode::kInvalidInput, diagnosis["what"].Text(),
                   cures == Cures::kTold ? diagnosis["cure"].Text() : std::string()});
}

std::string Listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

// What a reader of good edges should know: each sentence once, with the pairs that it is about, each of these once.
void PrintNotes(const std::vector<Document>& edges, Cures cures, std::ostream& out) {
  std::vector<std::pair<std::string, std::vector<std::string>>> notes;  // sentence, pairs; in the order of the edges
  for (const Document& edge : edges) {
    if (edge["state"].Text() == "failed") continue;
    for (const Document& item : edge["diagnoses"].Items()) {
      const std::string sentence = SentenceOf(item, cures), pair = PairOf(edge);
      auto known = std::find_if(notes.begin(), notes.end(), [&](const auto& note) { return note.first == sentence; });
      if (known == notes.end()) known = notes.insert(notes.end(), {sentence, {}});
      if (std::find(known->second.begin(), known->second.end(), pair) == known->second.end())
        known->second.push_back(pair);
    }
  }
  for (const auto& [sentence, pairs] : notes) out << Plain(Listed(pairs)) << ":\n  " << Plain(sentence) << '\n';
}

// By a word that another word takes back: how is told, too.
bool IsTakenOut(const std::string& code) {
  return code == kRetiredCode || code == kSensorRetiredCode || code == kSupersededCode;
}

void PrintPast(const std::vector<Document>& edges, std::ostream& out) {
  std::vector<std::pair<std::string, std::string>> reasons;  // reason, pairs; in the order of the edges
  for (const Document& edge : edges) {
    if (!IsPast(edge)) continue;
    const Document said = edge["diagnoses"][0];
    const std::string why = IsTakenOut(said["code"].Text()) ? SentenceOf(said) : said["what"].Text();
    const auto known = std::find_if(reasons.begin(), reasons.end(), [&](const auto& one) { return one.first == why; });
    if (known == reasons.end())
      reasons.emplace_back(why, PairOf(edge));
    else
      known->second += ", " + PairOf(edge);
  }
  for (const auto& [why, pairs] : reasons) out << Plain(pairs) << ": PAST\n  " << Plain(why) << '\n';
}

}  // namespace

std::string PairOf(const Document& edge) { return edge["frame_a"].Text("?") + " - " + edge["frame_b"].Text("?"); }

bool IsPast(const Document& edge) {
  return edge["state"].Text() == "failed" && MeansPast(edge["diagnoses"][0]["code"].Text());
}

void PrintDiagnoses(const Document& diagnoses, std::ostream& out, Cures cures) {
  for (const Document& item : diagnoses.Items()) out << "  " << Plain(SentenceOf(item, cures)) << '\n';
}

void PrintEdges(const std::vector<Document>& edges, std::ostream& out, EdgeIds ids, Cures cures) {
  std::vector<Column> columns = {{"A"},
                                 {"B"},
                                 {"METHOD"},
                                 {"p mm", Align::kRight},
                                 {"rpy deg", Align::kRight},
                                 {"sigma mm", Align::kRight},
                                 {"sigma deg", Align::kRight},
                                 {"|e| mm", Align::kRight},
                                 {"|e| deg", Align::kRight}};
  if (ids == EdgeIds::kShown) columns.insert(columns.begin(), {"EDGE"});
  Table table(std::move(columns));
  for (const Document& edge : edges)
    if (edge["state"].Text() != "failed") AddRow(edge, ids, table);
  if (!table.empty()) table.Print(out);
  for (const Document& edge : edges) {
    if (edge["state"].Text() != "failed" || IsPast(edge)) continue;
    out << Plain(PairOf(edge)) << ": FAILED\n";
    PrintDiagnoses(edge["diagnoses"], out);
  }
  PrintPast(edges, out);
  PrintNotes(edges, cures, out);
}

std::string EdgeLine(const Document& edge) {
  std::string line = edge["frame_a"].Text("?") + " - " + edge["frame_b"].Text("?") + "  " + MethodOf(edge) + "  " +
                     edge["state"].Text("?");
  if (edge["sigma_m"].size() == 3)
    line +=
        "  sigma " + Triple(edge["sigma_m"], kMmPerM, 3) + " mm, " + Triple(edge["sigma_rad"], kDegPerRad, 4) + " deg";
  if (edge["state"].Text() == "failed")
    for (const Document& item : edge["diagnoses"].Items()) line += "  " + SentenceOf(item, Cures::kLeftToTheCause);
  else if (const std::size_t notes = edge["diagnoses"].size(); notes > 0)
    line += notes == 1 ? ", 1 note" : ", " + std::to_string(notes) + " notes";
  return Plain(line);
}

void PrintGlobalError(const Document& revision, std::ostream& out) {
  const Document e_global = revision["e_global"];
  if (e_global.IsNull()) return;
  out << "E_global  before " << PartsText(e_global["before"]) << "  after " << PartsText(e_global["after"]) << '\n';
  if (revision["dof"].Integer().value_or(1) <= 0)
    out << "          no loop of edges: each fits by construction, so this checks nothing\n";
}

}  // namespace rigcal::client
