// The query side: (verb, parameters) -> the /api/v1 document (docs/api.md), and the pages that are made when asked for.
// Reads only, but for a report that is to be drawn again, and summaries that a list brings up to date; one Store per
// calling thread.
#pragma once

#include <functional>
#include <string>

#include "server/base/stamp.h"
#include "server/formats/answers/answers.h"
#include "server/formats/answers/parameters.h"
#include "server/metrics/exposition.h"
#include "server/pipeline/answers/health.h"
#include "server/pipeline/reports/kept_reports.h"
#include "server/pipeline/revisions/whole_revision.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct AnswerContext {
  storage::Store& store;
  const Clock& clock;
  RevisionCache& revisions;
  Stamp started_at;
  std::string http_address;                 // "http://127.0.0.1:8080", empty without HTTP
  ServerHealth* health = nullptr;           // none: disk and database are looked at, there are no threads
  const UndrawnReports* undrawn = nullptr;  // none: every report can be drawn
  std::function<void()> work_arrived = {};  // a report is to be drawn
  std::function<std::vector<metrics::Reading>()> more_readings = {};  // for /metrics: what waits outside of the store
};

// A verb of docs/api.md, and what gives its document.
struct VerbAnswer {
  const char* verb;
  Result<std::string> (*answer)(const AnswerContext& context, const formats::Parameters& parameters);
};

// `json`: an object with the verb's parameters. Unknown verb, missing or bad parameter: kInvalidInput; unknown robot,
// sensor, session, edge: kNotFound.
[[nodiscard]] Result<std::string> Answer(const AnswerContext& context, const std::string& verb,
                                         const std::string& json);

// What the verb health tells; without `context.health` it looks for itself.
[[nodiscard]] formats::HealthAnswer LookAtHealth(const AnswerContext& context);
// As in kept_reports.h.
[[nodiscard]] Error WhyMissing(const AnswerContext& context, const RobotId& robot, int number, const std::string& file);

struct PageText {
  std::string body, content_type;
  bool immutable = false;  // named by its content
  int status = 200;        // of HTTP; 503: not alive, or not ready
};
// "/", "/boards/", "/robots/<id>/..." (robot_pages.h), "/experiments/..." (experiments.h), "/style.css",
// "/assets/<script>",
// "/healthz", "/readyz", "/metrics", "/api/v1/<verb>" with the query string as parameters. For a file of a numbered
// report, which is asked for only where it is missing: the error that says why (kept_reports.h).
[[nodiscard]] Result<PageText> AnswerPage(const AnswerContext& context, const std::string& path,
                                          const std::string& query);

}  // namespace rigcal::pipeline
