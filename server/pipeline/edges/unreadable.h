// READ: why pictures of a session could not be read, as far as their headers and ends tell.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "server/model/edges/edge.h"
#include "server/model/sessions/session.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Of pictures that no edge shows, which are those that nothing could be drawn of; at most some dozens are looked at.
struct Unreadable {
  std::map<std::pair<CaptureId, SensorId>, std::string> why;
  bool all_looked_at = true;
};
// Pictures in the order of the manifest; why, in the words of the reader.
[[nodiscard]] Unreadable FindUnreadable(storage::Store& store, const Manifest& manifest,
                                        const std::vector<Edge>& edges);

}  // namespace rigcal::pipeline
