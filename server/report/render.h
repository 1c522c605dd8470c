// Values -> files. HTML through ctemplate with auto-escaping; JSON is written by formats. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/documents.h"
#include "server/model/approval/decision.h"
#include "server/model/approval/validity.h"
#include "server/model/boards/remark.h"
#include "server/model/robots/fleet_list.h"
#include "server/model/sessions/as_found.h"
#include "server/report/cameras/camera_choice.h"
#include "server/report/sections/cloud_section.h"

namespace rigcal::report {

// What sessions say of a sensor.
struct SensorFacts {
  SensorKind kind = SensorKind::kCamera;
  std::optional<Se3> T_ref_nominal;  // in the revision's reference
};
struct SessionFacts {
  SessionId id;
  Stamp captured_at;
  std::string operator_name, rig_model;
  std::vector<std::string> boards;  // that a sensor saw: "board: checkerboard 9 x 6, 25 mm"
  std::size_t files = 0;
  std::vector<BoardRemark> board_remarks = {};
  std::map<std::string, std::string> conditions = {};
  // Of the boards that session.yaml lists besides: nobody knows whether a sensor saw it; none did.
  std::vector<std::string> boards_perhaps_seen = {}, boards_unseen = {};
};
// The test of an edge's residual: beyond `limit` it contradicts; limit 0: nothing tests it.
struct EdgeLimit {
  double statistic = 0.0, limit = 0.0;
};
struct PastRevision {
  int number = 0;
  formats::RevisionInput revision;
};

struct ReportInput {
  int number = 0;
  Stamp created_at;
  Digest digest;                    // of the revision's document
  formats::RevisionInput revision;  // whole
  std::string software_version;
  std::vector<Digest> evidence;  // digests whose pictures exist; the rest is shown as missing
  CloudSection clouds;           // its files are put there by pipeline, too
  // What the document does not hold; each may be absent.
  std::map<SensorId, SensorFacts> sensors;
  std::vector<SessionFacts> sessions;
  std::map<EdgeId, EdgeLimit> limits;
  std::map<EdgeId, std::vector<BlockVector>> blocks;
  // Edges of earlier visits of which nothing new is told: the revisions whose reports have their details. None of
  // those that are worth another look (WorthDetails).
  std::map<EdgeId, int> detailed_in;
  std::vector<CameraReport> cameras;  // sorted by name; of the others nothing was kept
  std::optional<PastRevision> previous;
  std::optional<AsFound> as_found;              // what its newest session found of the calibration in use
  std::optional<Stamp> calibrated_at;           // when what the revision counts was measured
  std::int64_t max_age_ns = kDefaultMaxAge_ns;  // how old that may become
  std::optional<UsableRevision> usable;         // what to use where this one is not to be used
  std::optional<Approval> approval = {};        // as of when the report is drawn; absent: not known
};
// Of its revision, and approved where nothing says otherwise; a page that is made once knows no now, so that it is
// never overdue.
[[nodiscard]] Validity ValidityOf(const ReportInput& input);

// File name (relative, '/'-separated) -> contents: index.html, certificate.html (certificate.h), revision.json (=
// document), edges.csv, style.css, and data.js (what scripts draw, as a script, because a page from disk may not
// fetch). Pipeline adds the pictures that the page names ("evidence/<digest>.<suffix>") and the scripts ("assets/...",
// assets.h).
[[nodiscard]] Result<std::map<std::string, std::string>> RenderRevision(const ReportInput& input,
                                                                        const std::string& document);

// Fleet index "/" (a page of it). The pages of one robot: robot_pages.h. `experiments`, `boards`: how many there are to
// link to.
[[nodiscard]] Result<std::string> RenderFleet(const FleetCounts& fleet, const FleetPage& list, Stamp now,
                                              const FleetQuery& query = {}, std::size_t experiments = 0,
                                              std::size_t boards = 0);
// Drawing of the sensor graph alone: circles and edges, labels escaped, failed edges dashed.
[[nodiscard]] std::string RenderGraphSvg(const formats::RevisionInput& revision);
[[nodiscard]] std::string StyleSheet();

}  // namespace rigcal::report
