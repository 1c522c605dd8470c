// Values -> files. HTML through ctemplate with auto-escaping; JSON is written by formats. Pure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/formats/documents.h"
#include "server/report/cloud_section.h"

namespace rigcal::report {

struct ReportInput {
  int number = 0;
  Stamp created_at;
  Digest digest;                    // of the revision's document
  formats::RevisionInput revision;  // edges with evidence
  std::string software_version;
  std::vector<Digest> evidence;  // digests whose pictures exist; the rest is shown as missing
  CloudSection clouds;           // its files are put there by pipeline, too
};

// File name (relative, '/'-separated) -> contents. Contains index.html, revision.json (= document), style.css.
// Pictures are referenced as "evidence/<digest>.<suffix>"; pipeline puts them there.
[[nodiscard]] Result<std::map<std::string, std::string>> RenderRevision(const ReportInput& input,
                                                                        const std::string& document);

struct FleetRow {
  RobotId robot;
  int revision = 0;  // 0: none yet
  Verdict verdict;
  Stamp calibrated_at;  // newest capture behind a good edge; 0: never
  std::int64_t sessions = 0, edges = 0;
  bool overdue = false;
};
// Fleet index "/" and robot page "/robots/<id>/" (its revisions, newest first).
[[nodiscard]] Result<std::string> RenderFleet(const std::vector<FleetRow>& rows, Stamp now);
[[nodiscard]] Result<std::string> RenderRobot(const FleetRow& row, const std::vector<Revision>& revisions, Stamp now);
// Drawing of the sensor graph alone: circles and edges, labels escaped, failed edges dashed.
[[nodiscard]] std::string RenderGraphSvg(const formats::RevisionInput& revision);
[[nodiscard]] std::string StyleSheet();

}  // namespace rigcal::report
