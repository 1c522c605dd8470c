// What a site sends on and a centre looks up: sessions as they were pushed, their files by content, batches of edges.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/ids.h"
#include "storage/store.h"

namespace rigcal::storage {

struct NamedPayload {
  RobotId robot;  // whose session it is
  std::uint32_t idx = 0;
  std::int64_t size_bytes = 0;
  bool is_held = false;  // by this session, and not lost since
};
// Of several of the same content the first. Nothing where the session is not known or names no such file.
[[nodiscard]] Result<std::optional<NamedPayload>> LoadNamedPayload(Store& store, const SessionId& session,
                                                                   const Digest& digest);

// Its manifest, byte for byte: the session's id is its hash. kNotFound where the session is not known.
[[nodiscard]] Result<std::string> LoadManifestText(Store& store, const SessionId& session);

// Up to `limit` items of a batch, from `first` on.
struct BatchPart {
  RobotId robot;
  std::int64_t count = 0;  // of the whole batch
  std::vector<std::pair<std::int64_t, EdgeId>> items;
};
// kNotFound where the batch is not known.
[[nodiscard]] Result<BatchPart> LoadBatchPart(Store& store, const BatchId& batch, std::int64_t first,
                                              std::int64_t limit);

}  // namespace rigcal::storage
