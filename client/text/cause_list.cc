#include "client/text/cause_list.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "client/text/edge_table.h"
#include "client/text/table.h"

namespace rigcal::client {
namespace {

std::string CountOfFailures(std::size_t pairs) {
  return std::to_string(pairs) + (pairs == 1 ? " failed pair" : " failed pairs");
}

// Without its stop, to go on.
std::string Begun(std::string sentence) {
  if (!sentence.empty() && sentence.back() == '.') sentence.pop_back();
  return sentence;
}

void PrintCause(const Document& cause, std::ostream& out) {
  const std::size_t pairs = cause["edges"].size();
  const std::string command = cause["command"].Text();
  out << "  " << Plain(Begun(cause["why"].Text()))
      << (pairs > 0 ? "; explains " + CountOfFailures(pairs) + ". " : std::string(". "))
      << Plain(cause["what_to_do"].Text()) << (command.empty() ? "" : " Then:") << '\n';
  if (!command.empty()) out << "    " << Plain(command) << '\n';
}

using TwoSensors = std::pair<std::string, std::string>;  // by name

TwoSensors SensorsOf(const Document& edge) { return std::minmax(edge["frame_a"].Text(), edge["frame_b"].Text()); }

// Which cause explains an edge, or its pair.
class Explained {
 public:
  Explained(const std::vector<Document>& causes, const std::vector<Document>& edges) {
    for (std::size_t i = 0; i < causes.size(); ++i)
      for (const Document& edge : causes[i]["edges"].Items()) by_id_.emplace(edge.Text(), i);
    for (const Document& edge : edges)
      if (const auto found = by_id_.find(edge["id"].Text()); found != by_id_.end())
        by_pair_.emplace(SensorsOf(edge), found->second);
  }
  [[nodiscard]] std::optional<std::size_t> By(const Document& edge) const {
    if (edge["state"].Text() != "failed" || IsPast(edge)) return std::nullopt;
    if (const auto found = by_id_.find(edge["id"].Text()); found != by_id_.end()) return found->second;
    const auto found = by_pair_.find(SensorsOf(edge));
    return found == by_pair_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::map<std::string, std::size_t> by_id_;
  std::map<TwoSensors, std::size_t> by_pair_;
};

using Pairs = std::map<TwoSensors, std::string>;  // each once, with its name

void PrintPairs(const Document& cause, const Pairs& pairs, std::ostream& out) {
  if (pairs.empty()) return;
  out << "FAILED, " << pairs.size() << (pairs.size() == 1 ? " pair: " : " pairs: ") << Plain(cause["why"].Text())
      << '\n';
  const char* before = "  ";
  for (const auto& [sensors, name] : pairs) {
    out << before << Plain(name);
    before = ", ";
  }
  out << '\n';
}

}  // namespace

void PrintCauses(const Document& causes, std::ostream& out) {
  if (causes.size() == 0) return;
  out << "Causes, each with what to do\n";
  for (const Document& cause : causes.Items()) PrintCause(cause, out);
}

void PrintEdgesByCause(const Document& causes, const std::vector<Document>& edges, std::ostream& out) {
  const std::vector<Document> all = causes.Items();
  const Explained explained(all, edges);
  std::vector<Document> others;
  std::vector<Pairs> pairs(all.size());
  for (const Document& edge : edges)
    if (const auto cause = explained.By(edge))
      pairs[*cause].emplace(SensorsOf(edge), PairOf(edge));
    else
      others.push_back(edge);
  PrintEdges(others, out, EdgeIds::kHidden, all.empty() ? Cures::kTold : Cures::kLeftToTheCause);
  for (std::size_t i = 0; i < all.size(); ++i) PrintPairs(all[i], pairs[i], out);
}

}  // namespace rigcal::client
