#include "server/sites/send.h"

#include <map>

#include "storage/edges/edges.h"
#include "storage/files/blobs.h"
#include "storage/sessions/sessions.h"
#include "storage/sites/content.h"

namespace rigcal::sites {
namespace {

constexpr int kRounds = 3;  // of asking what is missing: more than one only where the centre lost something meanwhile
constexpr std::int64_t kEdgesAtOnce = 128;

Result<std::map<Digest, std::int64_t>> SizesOf(storage::Store& store, const SessionId& session) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, session));
  std::map<Digest, std::int64_t> sizes;
  if (manifest)
    for (const Payload& payload : manifest->payloads) sizes.emplace(payload.digest, payload.size_bytes);
  return sizes;
}

Error NotWhole(const std::string& subject) {
  return {ErrorCode::kUnreachable, "the centre does not say that it has all of " + subject, "It is sent again."};
}

// Its edges, each with its place in the batch.
Result<formats::EdgeSlice> SliceOf(storage::Store& store, const storage::BatchPart& part) {
  std::vector<EdgeId> ids;
  for (const auto& [idx, id] : part.items) ids.push_back(id);
  RIGCAL_ASSIGN(std::vector<Edge> edges, storage::LoadEdges(store, ids));
  std::map<EdgeId, Edge*> by_id;
  for (Edge& edge : edges) by_id.emplace(edge.id, &edge);
  formats::EdgeSlice slice{part.robot, part.count, {}};
  for (const auto& [idx, id] : part.items)
    if (const auto edge = by_id.find(id); edge != by_id.end()) slice.items.emplace_back(idx, *edge->second);
  return slice;
}

}  // namespace

Status SendSession(storage::Store& store, const CentreLink& link, const SessionId& session) {
  RIGCAL_ASSIGN(const std::string text, storage::LoadManifestText(store, session));
  for (int round = 0; round < kRounds; ++round) {
    RIGCAL_ASSIGN(const formats::ForwardReceipt receipt, link.SendManifest(session, text));
    if (receipt.is_whole) return {};
    RIGCAL_ASSIGN(const auto sizes, SizesOf(store, session));
    std::vector<CentreLink::BlobFile> blobs;
    for (const Digest& digest : receipt.missing)
      if (const auto size = sizes.find(digest); size != sizes.end())
        blobs.push_back({digest, storage::BlobPath(store.BlobFolder(), digest), size->second});
    RIGCAL_TRY(link.SendBlobs(session, blobs));
  }
  return Fail(NotWhole("session " + session.str()));
}

Status SendBatch(storage::Store& store, const CentreLink& link, const BatchId& batch) {
  bool is_whole = false;
  for (std::int64_t first = 0;; first += kEdgesAtOnce) {
    RIGCAL_ASSIGN(const storage::BatchPart part, storage::LoadBatchPart(store, batch, first, kEdgesAtOnce));
    if (part.items.empty()) break;
    RIGCAL_ASSIGN(const formats::EdgeSlice slice, SliceOf(store, part));
    RIGCAL_ASSIGN(const formats::ForwardReceipt receipt, link.SendEdges(batch, slice));
    is_whole = receipt.is_whole;
  }
  return is_whole ? Status() : Fail(NotWhole("batch " + batch.str()));
}

}  // namespace rigcal::sites
