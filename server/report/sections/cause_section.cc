#include "server/report/sections/cause_section.h"

#include <unordered_map>

#include "server/report/edges/cause_groups.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

using ShownById = std::unordered_map<EdgeId, const ShownEdge*>;

void FillExplained(Dictionary& item, const Cause& cause, const ShownById& shown) {
  if (cause.edges.empty()) return;
  Dictionary* explains = item.AddSectionDictionary("EXPLAINS");
  explains->SetValue("COUNT", Count(cause.edges.size(), "failed pair", "failed pairs"));
  std::vector<const ShownEdge*> edges;
  for (const EdgeId& edge : cause.edges)
    if (const auto found = shown.find(edge); found != shown.end()) edges.push_back(found->second);
  FillPairs(*explains, edges);
}

}  // namespace

void FillCauses(Dictionary& page, const std::vector<Cause>& causes, const std::vector<ShownEdge>& edges) {
  if (causes.empty()) return;
  ShownById shown;
  for (const ShownEdge& one : edges) shown.emplace(one.edge->id, &one);
  Dictionary* section = page.AddSectionDictionary("CAUSES_SECTION")->AddIncludeDictionary("CAUSES");
  section->SetFilename("causes.tpl");
  for (const Cause& cause : causes) {
    Dictionary* item = section->AddSectionDictionary("CAUSE");
    item->SetValue("WHY", cause.why);
    item->SetValue("WHAT_TO_DO", cause.what_to_do);
    if (!cause.command.empty()) ShowValue(*item, "COMMAND", "TEXT", cause.command);
    FillExplained(*item, cause, shown);
  }
}

}  // namespace rigcal::report
