#include "server/centre.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>

#include "server/base/digests/sha256.h"
#include "server/base/limits.h"
#include "server/base/site_robots.h"
#include "server/base/stamp.h"
#include "server/formats/documents.h"
#include "server/formats/json/json_writer.h"
#include "server/formats/sites/forward.h"
#include "server/pipeline/robots/validity.h"
#include "server/thread_store.h"
#include "storage/edges/edges.h"
#include "storage/files/held_files.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"
#include "storage/sites/content.h"

namespace rigcal {
namespace {

using dds::ReceiptWatches;
using http::SiteRequest;
using wire::ReceiptState;

constexpr std::chrono::milliseconds kAnsweredWithin{30'000}, kLookAgain{200};

struct Centre {
  storage::StorePlace place;
  const ServiceRelay& relay;
  ReceiptWatches& watches;
  // A text takes many times its memory while it is read: one after the other.
  std::shared_ptr<std::mutex> reading = std::make_shared<std::mutex>();
};

template <typename Value>
Result<Value> ReadAlone(const Centre& centre, const std::string& text, Result<Value> (*reads)(std::string_view)) {
  const std::lock_guard lock(*centre.reading);
  return reads(text);
}

Status CheckMaySend(const http::Person& site, const RobotId& robot) {
  if (IsAmongRobots(site.robots, robot.str())) return {};
  return Fail(
      ErrorCode::kInvalidInput,
      "robot " + robot.str() + " is none of the site " + site.name + ", whose token is of robots " + site.robots,
      "Make a token of its robots at the centre: `rigcal token new NAME --role site --robots NAMES`");
}

Error NoSuchThing() {
  return {ErrorCode::kNotFound, "there is nothing of that kind for sites here", "docs/api.md, forward, says what is."};
}

// The first receipt of this robot that says enough, or the refusal that came instead: another robot's of the same id
// is of somebody who made a mistake, or names what is not his.
Result<wire::Receipt> Await(const Centre& centre, ReceiptWatches::Watch& watch, const RobotId& robot,
                            const std::function<bool(const wire::Receipt&)>& is_enough) {
  const auto ends = [&](const wire::Receipt& receipt) {
    return receipt.robot == robot && (receipt.state == ReceiptState::kRefused || is_enough(receipt));
  };
  const auto until = std::chrono::steady_clock::now() + kAnsweredWithin;
  while (centre.relay.IsOpen() && std::chrono::steady_clock::now() < until) {
    auto receipt = watch.Await(ends, std::chrono::steady_clock::now() + kLookAgain);
    if (!receipt) continue;
    if (receipt->state != ReceiptState::kRefused) return *std::move(receipt);
    return Fail(receipt->error.value_or(Error{ErrorCode::kInternal, "it was refused", "See the server's log."}));
  }
  return Fail(ErrorCode::kBusy, "the server has not come to it yet", "Send it again in a moment.");
}

std::string ReceiptOf(const wire::Receipt& receipt, const Manifest& manifest) {
  formats::ForwardReceipt told{receipt.state == ReceiptState::kClosed};
  std::set<Digest> missing;
  for (std::size_t i = 0; !told.is_whole && i < manifest.payloads.size(); ++i)
    if (i >= receipt.held.size() || !receipt.held[i])
      if (missing.insert(manifest.payloads[i].digest).second) told.missing.push_back(manifest.payloads[i].digest);
  return formats::WriteForwardReceipt(told);
}

Result<std::string> ReadWhole(const SiteRequest& request, std::size_t bytes_max) {
  if (request.body_bytes > static_cast<std::int64_t>(bytes_max))
    return Fail(ErrorCode::kInvalidInput,
                "a body of " + std::to_string(request.body_bytes) + " bytes, more than " + std::to_string(bytes_max),
                "Send less at once.");
  return request.read(static_cast<std::size_t>(request.body_bytes));
}

Result<std::string> TakeManifest(const Centre& centre, const SiteRequest& request, const SessionId& session) {
  RIGCAL_ASSIGN(std::string text, ReadWhole(request, static_cast<std::size_t>(limits::kManifestBytesMax)));
  RIGCAL_ASSIGN(const Manifest manifest, ReadAlone(centre, text, &formats::ReadManifest));
  RIGCAL_TRY(CheckMaySend(request.site, manifest.header.robot));
  RIGCAL_ASSIGN(auto superseded_by, formats::ReadSupersededBy(request.query));
  if (Sha256Of(text).str() != session.str())
    return Fail(ErrorCode::kInvalidInput, "the manifest of session " + session.str() + " has another hash",
                "Check the disk of the site's server: `rigcal fsck`.");
  ReceiptWatches::Watch watch(centre.watches, session.str());
  RIGCAL_TRY(centre.relay.TakeIn(
      dds::ManifestText{manifest.header.robot, session, std::move(text), std::move(superseded_by)}));
  RIGCAL_ASSIGN(const wire::Receipt receipt, Await(centre, watch, manifest.header.robot, [](const wire::Receipt& told) {
                  return told.state == ReceiptState::kClosed || told.state == ReceiptState::kReceiving;
                }));
  return ReceiptOf(receipt, manifest);
}

Result<storage::NamedPayload> FindPayload(const Centre& centre, const SiteRequest& request, const SessionId& session,
                                          const Digest& digest) {
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(centre.place));
  RIGCAL_ASSIGN(auto named, storage::LoadNamedPayload(*store, session, digest));
  if (!named)
    return Fail(ErrorCode::kNotFound, "session " + session.str() + " is not known here with a file " + digest.str(),
                "Send its manifest first.");
  RIGCAL_TRY(CheckMaySend(request.site, named->robot));
  if (!named->is_held) return *named;
  RIGCAL_ASSIGN(const auto states, storage::CheckHeld(*store, {{digest, named->size_bytes}}, SystemClock().Now()));
  named->is_held = states.front() != storage::HeldState::kLost;
  return *named;
}

// All of the body, also of a file that is held already; the recorder holds it against its hash, too.
Result<Digest> HandOn(const Centre& centre, const SiteRequest& request, const SessionId& session,
                      const storage::NamedPayload& named) {
  Sha256 hash;
  for (std::uint64_t offset_bytes = 0;;) {
    RIGCAL_ASSIGN(std::string bytes, request.read(limits::kChunkBytesMax));
    if (bytes.empty()) return hash.Finish();
    const std::size_t count = bytes.size();
    hash.Add(std::string_view(bytes));
    if (!named.is_held)
      RIGCAL_TRY(centre.relay.TakeIn(dds::ChunkBytes{named.robot, session, named.idx, offset_bytes, std::move(bytes)}));
    offset_bytes += count;
  }
}

Result<std::string> TakeBlob(const Centre& centre, const SiteRequest& request, const SessionId& session,
                             const Digest& digest) {
  RIGCAL_ASSIGN(const storage::NamedPayload named, FindPayload(centre, request, session, digest));
  if (request.body_bytes != named.size_bytes)
    return Fail(ErrorCode::kInvalidInput,
                "file " + digest.str() + " has " + std::to_string(named.size_bytes) + " bytes, and not " +
                    std::to_string(request.body_bytes),
                "Send it as the manifest lists it.");
  ReceiptWatches::Watch watch(centre.watches, session.str());
  RIGCAL_ASSIGN(const Digest got, HandOn(centre, request, session, named));
  if (got != digest)
    return Fail(ErrorCode::kInvalidInput, "file " + digest.str() + ": its bytes do not have this hash",
                "Check the disk of the site's server: `rigcal fsck`.");
  if (named.is_held) return formats::WriteForwardReceipt({});
  RIGCAL_ASSIGN(const wire::Receipt receipt, Await(centre, watch, named.robot, [&](const wire::Receipt& told) {
                  return told.state != ReceiptState::kReceiving ||
                         (named.idx < told.held.size() && told.held[named.idx]);
                }));
  if (receipt.state == ReceiptState::kNeedManifest)
    return Fail(ErrorCode::kNotFound, "session " + session.str() + " is not known here", "Send its manifest first.");
  return formats::WriteForwardReceipt({receipt.state == ReceiptState::kClosed});
}

Result<std::string> FindBlob(const Centre& centre, const SiteRequest& request, const SessionId& session,
                             const Digest& digest) {
  RIGCAL_ASSIGN(const storage::NamedPayload named, FindPayload(centre, request, session, digest));
  if (named.is_held) return formats::WriteForwardReceipt({});
  return Fail(ErrorCode::kNotFound, "file " + digest.str() + " of session " + session.str() + " is not here yet",
              "Send it.");
}

// Checked as those that come over DDS: the ids belong to the content.
Result<std::vector<wire::BatchItem>> ItemsOf(const BatchId& batch, formats::EdgeSlice slice) {
  std::vector<wire::BatchItem> items;
  for (auto& [idx, edge] : slice.items) {
    if (edge.robot != slice.robot)
      return Fail(ErrorCode::kInvalidInput,
                  "an edge of robot " + edge.robot.str() + " in a batch of robot " + slice.robot.str(),
                  "Send each robot's edges by themselves.");
    RIGCAL_ASSIGN(const auto sample,
                  wire::ToPairwiseResult({batch, static_cast<std::uint32_t>(idx),
                                          static_cast<std::uint32_t>(slice.count), std::move(edge)}));
    RIGCAL_ASSIGN(wire::BatchItem item, wire::FromPairwiseResult(sample.sample));
    items.push_back(std::move(item));
  }
  return items;
}

Result<std::string> TakeEdges(const Centre& centre, const SiteRequest& request, const BatchId& batch) {
  RIGCAL_ASSIGN(const std::string text, ReadWhole(request, formats::kEdgeSliceBytesMax));
  RIGCAL_ASSIGN(formats::EdgeSlice slice, ReadAlone(centre, text, &formats::ReadEdgeSlice));
  const RobotId robot = slice.robot;
  RIGCAL_TRY(CheckMaySend(request.site, robot));
  RIGCAL_ASSIGN(std::vector<wire::BatchItem> items, ItemsOf(batch, std::move(slice)));
  if (items.empty()) return Fail(ErrorCode::kInvalidInput, "a batch without edges", "Send one edge at least.");
  std::vector<std::uint32_t> sent;
  for (const wire::BatchItem& item : items) sent.push_back(item.idx);
  ReceiptWatches::Watch watch(centre.watches, batch.str());
  for (wire::BatchItem& item : items) RIGCAL_TRY(centre.relay.TakeIn(std::move(item)));
  RIGCAL_ASSIGN(const wire::Receipt receipt, Await(centre, watch, robot, [&](const wire::Receipt& told) {
                  return std::all_of(sent.begin(), sent.end(),
                                     [&](std::uint32_t idx) { return idx < told.held.size() && told.held[idx]; });
                }));
  return formats::WriteForwardReceipt({receipt.state == ReceiptState::kClosed});
}

Error NotAllHere(const std::string& subject) {
  return {ErrorCode::kNotFound, "not all of " + subject + " is here", "Send it."};
}

Result<std::string> FindSession(const Centre& centre, const SiteRequest& request, const SessionId& session) {
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(centre.place));
  RIGCAL_ASSIGN(auto known, storage::LoadSession(*store, session));
  if (!known) return Fail(NotAllHere("session " + session.str()));
  RIGCAL_TRY(CheckMaySend(request.site, known->robot));
  RIGCAL_TRY(storage::NoteLostFiles(*store, session, SystemClock().Now()));
  RIGCAL_ASSIGN(known, storage::LoadSession(*store, session));
  if (!known->closed || known->payloads_held < known->payloads) return Fail(NotAllHere("session " + session.str()));
  return formats::WriteForwardReceipt({true});
}

Result<std::string> FindBatch(const Centre& centre, const SiteRequest& request, const BatchId& batch) {
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(centre.place));
  RIGCAL_ASSIGN(const auto held, storage::LoadBatchHeld(*store, batch));
  if (!held) return Fail(NotAllHere("batch " + batch.str()));
  RIGCAL_ASSIGN(const auto part, storage::LoadBatchPart(*store, batch, 0, 0));
  RIGCAL_TRY(CheckMaySend(request.site, part.robot));
  if (std::find(held->begin(), held->end(), false) != held->end()) return Fail(NotAllHere("batch " + batch.str()));
  return formats::WriteForwardReceipt({true});
}

// What robots are to use there; nothing where nothing is.
Result<std::optional<formats::WordAtCentre>> InUseOf(storage::Store& store, const RobotId& robot) {
  using InUse = std::optional<formats::WordAtCentre>;
  RIGCAL_ASSIGN(const auto usable, pipeline::LoadUsable(store, robot));
  if (!usable) return InUse();
  RIGCAL_ASSIGN(const auto decision, storage::LoadInUse(store, robot));
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(store, robot, usable->number));
  if (!decision || !revision) return InUse();
  const Word& word = decision->word;
  return InUse({robot, revision->digest, word.at, word.who, word.reason, decision->how});
}

// What people there said no to last.
Status AddRejected(storage::Store& store, const RobotId& robot, std::vector<formats::WordAtCentre>& told) {
  constexpr std::int64_t kOfRobotMax = 4;
  RIGCAL_ASSIGN(const auto rejected, storage::LoadRejections(store, robot, kOfRobotMax));
  for (const auto& [digest, word] : rejected)
    if (told.size() < formats::kRobotsAskedMax)
      told.push_back({robot, digest, word.at, word.who, word.reason, "rejected"});
  return {};
}

Result<std::string> TellInUse(const Centre& centre, const SiteRequest& request) {
  RIGCAL_ASSIGN(const std::string text, ReadWhole(request, formats::kRobotsAskedBytesMax));
  RIGCAL_ASSIGN(const auto robots, formats::ReadRobotsAsked(text));
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(centre.place));
  formats::WordsAtCentre told;
  for (const RobotId& robot : robots) {
    if (!IsAmongRobots(request.site.robots, robot.str())) continue;
    RIGCAL_ASSIGN(auto in_use, InUseOf(*store, robot));
    if (in_use) told.in_use.push_back(*std::move(in_use));
    RIGCAL_TRY(AddRejected(*store, robot, told.rejected));
  }
  return formats::WriteWordsAtCentre(told);
}

std::string Greeting(const http::Person& site) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("site", site.name);
    out.Text("robots", site.robots);
  });
}

// "/sessions/<id>/blobs/<digest>" -> sessions, <id>, blobs, <digest>.
std::vector<std::string> WordsOf(const std::string& path) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < path.size();) {
    const std::size_t end = std::min(path.find('/', at + 1), path.size());
    words.push_back(path.substr(at + 1, end - at - 1));
    at = end;
  }
  return words;
}

Result<std::string> Answer(const Centre& centre, const SiteRequest& request) {
  const std::vector<std::string> words = WordsOf(request.path);
  const bool is_read = request.method == "GET" || request.method == "HEAD";
  if (words.empty() && is_read) return Greeting(request.site);
  if (words.size() == 1 && words[0] == "in_use" && request.method == "POST") return TellInUse(centre, request);
  if (words.size() == 2 && words[0] == "batches") {
    RIGCAL_ASSIGN(const BatchId batch, BatchId::Parse(words[1]));
    if (request.method == "POST") return TakeEdges(centre, request, batch);
    return is_read ? FindBatch(centre, request, batch) : Fail(NoSuchThing());
  }
  if (words.size() < 2 || words[0] != "sessions") return Fail(NoSuchThing());
  RIGCAL_ASSIGN(const SessionId session, SessionId::Parse(words[1]));
  if (words.size() == 2 && request.method == "POST") return TakeManifest(centre, request, session);
  if (words.size() == 2 && is_read) return FindSession(centre, request, session);
  if (words.size() != 4 || words[2] != "blobs") return Fail(NoSuchThing());
  RIGCAL_ASSIGN(const Digest digest, Digest::Parse(words[3]));
  if (request.method == "PUT") return TakeBlob(centre, request, session, digest);
  return is_read ? FindBlob(centre, request, session, digest) : Fail(NoSuchThing());
}

}  // namespace

http::AnswerSite AnswerSites(const storage::StorePlace& place, const ServiceRelay& relay,
                             dds::ReceiptWatches& watches) {
  return [centre = Centre{place, relay, watches}](const SiteRequest& request) { return Answer(centre, request); };
}

sites::Forwarder::Options ForwardingOf(const storage::StorePlace& place, const sites::CentreAddress& centre,
                                       Vitals& vitals, const ServiceRelay& relay) {
  return {place, &SystemClock(), centre, &vitals,
          [&relay](const std::string& verb, const std::string& json) { return relay.GiveOrder(verb, json); }};
}

dds::Callbacks WithSites(dds::Callbacks callbacks, dds::ReceiptWatches& watches, sites::Forwarder& forwarder) {
  callbacks.receipt_sent = [&watches](const wire::Receipt& receipt) { return watches.Note(receipt); };
  callbacks.work_arrived = [&forwarder, arrived = callbacks.work_arrived](const RobotId& robot) {
    forwarder.Wake();
    arrived(robot);
  };
  return callbacks;
}

}  // namespace rigcal
