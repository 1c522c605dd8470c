#include "server/report/edges/detail_sections.h"

#include <set>

#include "server/report/edges/edge_section.h"
#include "server/report/text/edge_state.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kFoldsOpenMax = 8;  // more sections than this start folded, failed ones aside

std::vector<const ShownEdge*> AllOf(const EdgesByCause& edges) {
  std::vector<const ShownEdge*> all;
  for (const EdgeGroup& group : edges.groups) all.insert(all.end(), group.edges.begin(), group.edges.end());
  all.insert(all.end(), edges.others.begin(), edges.others.end());
  return all;
}

// What is left out of the page.
bool HasMore(const Edge& edge) { return !edge.captures.empty() || !edge.evidence.empty() || !edge.diagnoses.empty(); }

std::string EarlierText(std::size_t count) {
  return Count(count, "edge", "edges") +
         " of earlier visits: pictures and captures are in the reports of those visits, linked " +
         "from the table of edges.";
}

struct Sections {
  const ReportInput& input;
  std::set<Digest> stored;
  std::size_t pictures_max = 0;

  void Fill(Dictionary& place, const ShownEdge& shown, bool open) const {
    Dictionary* section = place.AddIncludeDictionary("DETAIL");
    section->SetFilename("edge.tpl");
    FillEdgeSection(*section, input, shown, stored, pictures_max, open);
  }
};

void FillGroup(Dictionary& fold, const EdgeGroup& group, const Sections& sections) {
  fold.SetValue("ANCHOR", group.anchor);
  fold.SetValue("COUNT", Count(group.pairs, "pair", "pairs"));
  fold.SetValue("WHY", group.cause->why);
  fold.SetValue("WHAT_TO_DO", group.cause->what_to_do);
  for (const ShownEdge* shown : group.edges)
    if (shown->detailed) sections.Fill(*fold.AddSectionDictionary("GROUPED"), *shown, false);
}

// Whoever opens none of the folds reads that something is in them.
void FillHeading(Dictionary& page, const std::vector<const ShownEdge*>& detailed) {
  Dictionary* heading = page.AddSectionDictionary("DETAILS");
  std::size_t warned = 0;
  for (const ShownEdge* shown : detailed) warned += WarningsOf(*shown->edge) > 0 ? 1 : 0;
  if (warned > 0)
    ShowValue(*heading, "WARNED", "TEXT",
              std::to_string(warned) + " of " + std::to_string(detailed.size()) + (warned == 1 ? " has" : " have") +
                  " warnings");
}

}  // namespace

void FillDetails(Dictionary& page, const ReportInput& input, const EdgesByCause& edges) {
  std::vector<const ShownEdge*> detailed;
  std::size_t earlier = 0, left = 0, alone = 0, failed_open = 0;
  for (const ShownEdge* shown : AllOf(edges))
    if (shown->detailed_in != 0)
      ++earlier;
    else if (shown->detailed)
      detailed.push_back(shown);
    else
      left += HasMore(*shown->edge) ? 1 : 0;
  if (!detailed.empty()) FillHeading(page, detailed);
  const Sections sections{input,
                          {input.evidence.begin(), input.evidence.end()},
                          detailed.size() > kManySections ? kPicturesPerEdgeMax / 2 : kPicturesPerEdgeMax};
  for (const EdgeGroup& group : edges.groups)
    if (!group.anchor.empty()) FillGroup(*page.AddSectionDictionary("DETAIL_GROUP"), group, sections);
  for (const ShownEdge* shown : edges.others) alone += shown->detailed ? 1 : 0;
  for (const ShownEdge* shown : edges.others)
    if (shown->detailed)
      sections.Fill(*page.AddSectionDictionary("DETAIL_SECTION"), *shown,
                    alone <= kFoldsOpenMax || (HasFailed(*shown->edge) && failed_open++ < kFoldsOpenMax));
  if (earlier > 0) ShowValue(page, "EARLIER_DETAILS", "TEXT", EarlierText(earlier));
  if (left > 0) ShowValue(page, "MORE_DETAILS", "COUNT", std::to_string(left));
}

}  // namespace rigcal::report
