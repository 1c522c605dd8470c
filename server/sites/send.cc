#include "server/sites/send.h"

#include <map>

#include "server/base/stamp.h"
#include "storage/edges/edges.h"
#include "storage/files/blobs.h"
#include "storage/files/lost_blobs.h"
#include "storage/sessions/sessions.h"
#include "storage/sites/content.h"
#include "storage/sites/superseded_there.h"

namespace rigcal::sites {
namespace {

constexpr int kRounds = 3;  // of asking what is missing: more than one only where the centre lost something meanwhile
constexpr std::int64_t kEdgesAtOnce = 128;
constexpr std::size_t kSliceBytes = formats::kEdgeSliceBytesMax / 2;
constexpr std::size_t kFetchedAtOnce = 64;

Result<std::map<Digest, std::int64_t>> SizesOf(storage::Store& store, const SessionId& session) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, session));
  std::map<Digest, std::int64_t> sizes;
  if (manifest)
    for (const Payload& payload : manifest->payloads) sizes.emplace(payload.digest, payload.size_bytes);
  return sizes;
}

// It took all that it asked for: others are not to wait for what goes wrong there.
Error NotWhole(const std::string& subject) {
  return {ErrorCode::kConflict, "the centre does not say that it has all of " + subject,
          "Look at the centre's log; it is sent again."};
}

// What of these files this disk has not kept, by their paths: damaged ones are set aside, and all count as lost.
Result<std::vector<std::string>> NoteLost(storage::Store& store, const CentreLink& link, const Manifest& manifest,
                                          const std::vector<Digest>& files) {
  std::map<Digest, std::string> paths;
  for (const Payload& payload : manifest.payloads) paths.emplace(payload.digest, payload.path);
  std::vector<std::string> lost;
  for (const Digest& digest : files) {
    const auto path = paths.find(digest);
    if (path == paths.end() || !link.GoesOn()) continue;
    RIGCAL_ASSIGN(const storage::BlobState state, storage::SetDamagedAside(store.blobs(), digest));
    if (state == storage::BlobState::kGood) continue;
    RIGCAL_TRY(storage::AppendLost(store, digest, state, std::nullopt, SystemClock().Now()));
    lost.push_back(path->second);
  }
  return lost;
}

// `error`, or that a file is lost, where that is why these did not go.
Error WhyNotSent(storage::Store& store, const CentreLink& link, const SessionId& session,
                 const std::vector<Digest>& files, const Error& error) {
  const auto manifest = storage::LoadManifest(store, session);
  if (!manifest || !*manifest) return error;
  const auto lost = NoteLost(store, link, **manifest, files);
  if (!lost || lost->empty()) return error;
  const std::string others = lost->size() == 1 ? "" : " and " + std::to_string(lost->size() - 1) + " more";
  return {ErrorCode::kStorage,
          "the disk here has not kept " + lost->front() + others + " of session " + session.str() + " of robot " +
              (*manifest)->header.robot.str(),
          "Push the session again: only what is lost is sent. Check this server's disk."};
}

// What a bucket alone has is fetched some files at a time: this thread is not to stand still.
Status SendMissing(storage::Store& store, const CentreLink& link, const SessionId& session,
                   const std::vector<Digest>& missing) {
  RIGCAL_ASSIGN(const auto sizes, SizesOf(store, session));
  const bool is_fetched = store.blobs().bucket() != nullptr;
  std::vector<CentreLink::BlobFile> files;
  for (const Digest& digest : missing) {
    const auto size = sizes.find(digest);
    if (size == sizes.end()) continue;
    if (is_fetched) RIGCAL_TRY(storage::FetchBlob(store.blobs(), digest));
    files.push_back({digest, storage::BlobPath(store.BlobFolder(), digest), size->second});
    if (!is_fetched || files.size() < kFetchedAtOnce) continue;
    RIGCAL_TRY(link.SendBlobs(session, files));
    files.clear();
  }
  return link.SendBlobs(session, files);
}

// About what it takes as text.
std::size_t BytesOf(const Edge& edge) {
  constexpr std::size_t kEdgeBytes = 8'192, kBlockBytes = 512;
  return kEdgeBytes + edge.uncertainty.blocks.size() * kBlockBytes;
}

// Edges of thousands of blocks go fewer at a time, one at least.
void KeepWhatFits(formats::EdgeSlice& slice) {
  std::size_t bytes = 0;
  auto end = slice.items.begin();
  for (; end != slice.items.end(); ++end) {
    bytes += BytesOf(end->second);
    if (end != slice.items.begin() && bytes > kSliceBytes) break;
  }
  slice.items.erase(end, slice.items.end());
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
  RIGCAL_ASSIGN(const auto superseding, storage::LoadSuperseding(store, session));
  Status sent;
  for (int round = 0; round < kRounds; ++round) {
    RIGCAL_ASSIGN(const formats::ForwardReceipt receipt, link.SendManifest(session, text, superseding));
    if (receipt.is_whole) return {};
    sent = SendMissing(store, link, session, receipt.missing);
    if (!sent && !IsOfTheWay(sent.error().code))
      sent = Fail(WhyNotSent(store, link, session, receipt.missing, sent.error()));
    if (!sent && sent.error().code != ErrorCode::kNotFound) return sent;  // else it forgot the manifest meanwhile
  }
  return sent ? Fail(NotWhole("session " + session.str())) : sent;
}

Status SendBatch(storage::Store& store, const CentreLink& link, const BatchId& batch) {
  bool is_whole = false;
  for (std::int64_t first = 0;;) {
    RIGCAL_ASSIGN(const storage::BatchPart part, storage::LoadBatchPart(store, batch, first, kEdgesAtOnce));
    if (part.items.empty()) break;
    RIGCAL_ASSIGN(formats::EdgeSlice slice, SliceOf(store, part));
    KeepWhatFits(slice);
    first = (slice.items.empty() ? part.items.back().first : slice.items.back().first) + 1;
    if (slice.items.empty()) continue;
    RIGCAL_ASSIGN(const formats::ForwardReceipt receipt, link.SendEdges(batch, slice));
    is_whole = receipt.is_whole;
  }
  return is_whole ? Status() : Fail(NotWhole("batch " + batch.str()));
}

}  // namespace rigcal::sites
