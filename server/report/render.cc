#include "server/report/render.h"

#include <algorithm>

#include "report_embedded.h"
#include "server/report/cameras/camera_section.h"
#include "server/report/drawings/drawing.h"
#include "server/report/edges/detail_sections.h"
#include "server/report/edges/page_data.h"
#include "server/report/edges/tables.h"
#include "server/report/frame/assets.h"
#include "server/report/frame/banner.h"
#include "server/report/pages/certificate.h"
#include "server/report/sections/as_found_section.h"
#include "server/report/sections/cause_section.h"
#include "server/report/sections/change_section.h"
#include "server/report/sections/fused_section.h"
#include "server/report/sections/key_figures.h"
#include "server/report/sections/loop_section.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

// When, by whom and of which kind of robot: of the newest visit that the revision holds. Of pushed edges, when they
// came.
void FillCaptured(Dictionary& page, const ReportInput& input) {
  const auto newest = std::max_element(input.sessions.begin(), input.sessions.end(), [](const auto& x, const auto& y) {
    return x.captured_at != y.captured_at ? x.captured_at < y.captured_at : x.id < y.id;
  });
  if (newest == input.sessions.end()) return page.ShowSection("NO_CAPTURED");
  Dictionary* captured = page.AddSectionDictionary("CAPTURED");
  captured->SetValue("DAY", DayText(newest->captured_at));
  if (!newest->operator_name.empty()) ShowValue(*captured, "OPERATOR", "NAME", newest->operator_name);
  if (!newest->rig_model.empty()) ShowValue(*captured, "RIG", "NAME", newest->rig_model);
  if (const std::size_t before = input.sessions.size() - 1; before > 0)
    ShowValue(*captured, "BEFORE", "SESSIONS", Count(before, "visit before it", "visits before it"));
}

void FillTitle(Dictionary& page, const ReportInput& input) {
  const std::string robot = input.revision.robot.str();
  FillHead(page,
           robot + ", revision " + std::to_string(input.number) + ": " + VerdictWord(input.revision.verdict.level), "");
  page.SetValue("ROBOT", robot);
  page.SetValue("NUMBER", std::to_string(input.number));
  page.SetValue("TIME", TimeText(input.created_at));
  page.SetValue("SHEET", IsUsable(input.revision.verdict) ? "Certificate" : "Record");
  page.SetValue("REFERENCE", input.revision.reference.str());
  FillCaptured(page, input);
  AddScript(page, AssetPath("tables.js"));
  AddScriptsLater(page, AssetPath("later.js"), {"data.js", AssetPath("charts.js"), AssetPath("rig.js")});
}

void FillDrawing(Dictionary& page, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges) {
  Dictionary* svg = page.AddIncludeDictionary("GRAPH");
  svg->SetFilename("graph.tpl");
  page.SetValue("GRAPH_NOTE", FillGraph(*svg, revision, edges));
}

}  // namespace

Result<std::map<std::string, std::string>> RenderRevision(const ReportInput& input, const std::string& document) {
  const auto edges = InOrder(input.revision, input.detailed_in);
  const EdgesByCause by_cause = GroupByCause(input.revision, edges);
  Dictionary page("revision");
  FillTitle(page, input);
  FillBanner(page, input.revision.verdict, ValidityOf(input), true, {}, input.revision.basis);
  FillCauses(page, input.revision.causes, edges);
  FillNotes(page, input.revision);
  FillKeyFigures(page, input.revision, edges, ValidityOf(input));
  FillChanges(page, input);
  FillAsFound(page, input);
  FillDrawing(page, input.revision, edges);
  FillPoses(page, input.revision);
  FillFused(page, input.revision);
  FillEdges(page, input, by_cause);
  FillLoops(page, input.revision);
  FillCameras(page, input);
  FillDetails(page, input, by_cause);
  FillClouds(page, input.clouds);
  FillProvenance(page, input);
  RIGCAL_ASSIGN(std::string html, Expand("revision.tpl", page));
  RIGCAL_ASSIGN(std::string certificate, RenderCertificate(input, StandingWhenDrawn(input), ""));
  return std::map<std::string, std::string>{
      {"index.html", std::move(html)},      {kCertificateFile, std::move(certificate)}, {"revision.json", document},
      {"edges.csv", EdgeCsv(input, edges)}, {"data.js", PageData(input, edges)},        {"style.css", StyleSheet()}};
}

Validity ValidityOf(const ReportInput& input) {
  Validity validity{input.calibrated_at, false, input.usable, false};
  validity.max_age_ns = input.max_age_ns;
  if (!input.approval || !IsUsable(input.revision.verdict)) return validity;
  const RevisionState state = input.approval->state;
  if (state == RevisionState::kSuperseded && input.usable) validity.superseded_by = input.usable->number;
  validity.approved = state == RevisionState::kApproved;
  return validity;
}

std::string StyleSheet() {
  return std::string(embedded::kstyle_css) + std::string(embedded::kfleet_css) + std::string(embedded::kpaper_css) +
         std::string(embedded::kreport_css);
}

}  // namespace rigcal::report
