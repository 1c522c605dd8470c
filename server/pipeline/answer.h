// The query side: (verb, parameters) -> the /api/v1 document (docs/api.md), and the pages that are made when asked for.
// Reads only; one Store per calling thread.
#pragma once

#include <string>

#include "server/base/stamp.h"
#include "server/pipeline/revision_cache.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct AnswerContext {
  storage::Store& store;
  const Clock& clock;
  RevisionCache& revisions;
  Stamp started_at;
  std::string http_address;  // "http://127.0.0.1:8080", empty without HTTP
};

// `json`: an object with the verb's parameters. Unknown verb, missing or bad parameter: kInvalidInput; unknown robot,
// sensor, session, edge: kNotFound.
[[nodiscard]] Result<std::string> Answer(const AnswerContext& context, const std::string& verb,
                                         const std::string& json);

struct PageText {
  std::string body, content_type;
  bool immutable = false;  // named by its content
};
// "/", "/robots/<id>/..." (robot_pages.h), "/experiments/..." (experiments.h), "/style.css", "/assets/<script>", "/healthz", "/metrics", "/api/v1/<verb>"
// with the query string as parameters.
[[nodiscard]] Result<PageText> AnswerPage(const AnswerContext& context, const std::string& path,
                                          const std::string& query);

}  // namespace rigcal::pipeline
