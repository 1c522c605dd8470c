#include "server/dds/record/session_commit.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/parallel_for.h"
#include "server/dds/tell/receipts.h"
#include "server/metrics/noted.h"
#include "storage/s3/store_bucket.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"
#include "storage/sites/superseded_there.h"

namespace rigcal::dds {
namespace {

constexpr std::int64_t kCommitBytes = 64LL << 20;  // complete payloads that may wait for a commit
constexpr std::chrono::seconds kHeldUpFor{2};

void NoteReceive(const SessionIntake& intake, bool failed) {
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - intake.began_at;
  metrics::Note({metrics::Stage::kReceive, took.count(), failed});
}

void LogHeld(const SessionIntake& intake, wire::ReceiptState state) {
  const std::string robot = intake.robot().str(), session = intake.session().str();
  LogReceipt(
      {.robot = robot, .session = session}, state,
      "robot " + robot + ", session " + session +
          (state == wire::ReceiptState::kClosed ? ": received, all of it is on disk" : ": a part of it is on disk"));
}

// One that is gone was synced and moved before a bucket held up the commit: AdoptBlobs looks whether that is so.
Status SyncAll(const std::vector<storage::FinishedFile>& files) {
  std::vector<Status> synced(files.size());
  ParallelFor(files.size(), [&](std::size_t i) { synced[i] = SyncFile(files[i].path); });
  for (const Status& one : synced)
    if (!one && one.error().code != ErrorCode::kNotFound) return one;
  return {};
}

Status Close(storage::Store& store, const SessionId& session, Stamp now) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, session));
  if (!manifest)
    return Fail(ErrorCode::kStorage, "session " + session.str() + " has no manifest", "Run `rigcal doctor`");
  RIGCAL_ASSIGN(const auto before, storage::LoadSession(store, session));
  RIGCAL_TRY(storage::CloseSession(store, session, PairsToCalibrate(manifest->header), now));
  if (!before || !before->closed) return {};
  RIGCAL_ASSIGN(const bool is_superseded_there, storage::TakeSupersedingNoted(store, session));
  if (is_superseded_there) return {};
  // What the disk had lost was sent again, and the session with it.
  const Word word{now, "robot " + before->robot.str(), ""};
  if (const auto current = storage::MakeCurrent(store, session, storage::MadeCurrent::kPushedAgain, word); !current)
    return Fail(current.error());
  return {};
}

Status Record(storage::Store& store, const DurableBatch& batch, Stamp now) {
  RIGCAL_TRY(storage::CheckBlobsStayed(store));
  for (const auto& [session, idx] : batch.held)
    RIGCAL_TRY(storage::AppendHeld(store, session, {idx.begin(), idx.end()}, now));
  for (const SessionId& session : batch.closing) RIGCAL_TRY(Close(store, session, now));
  return {};
}

// Syncs the files side by side, moves them to the blob store, then records all in ONE transaction. `cached` keeps the
// newest blobs in the page cache; `put`: what is in a bucket already.
Status Persist(storage::Store& store, const DurableBatch& batch, CachedFiles& cached, std::set<Digest>& put,
               Stamp now) {
  RIGCAL_TRY(SyncAll(batch.files));
  RIGCAL_TRY(storage::AdoptBlobs(store.blobs(), batch.files, put));
  RIGCAL_TRY(store.Write([&] { return Record(store, batch, now); }));
  for (const storage::FinishedFile& file : batch.files) cached.Add(storage::BlobPath(store.BlobFolder(), file.digest));
  return {};
}

}  // namespace

DurableCommit::DurableCommit(storage::Store& store, const Clock& clock, std::function<void()> done)
    : store_(store), clock_(clock), done_(std::move(done)), cached_(limits::kCachedBytes) {}

void DurableCommit::Start(DurableBatch batch) {
  batch_ = std::move(batch);
  is_done_ = false;
  // Where no thread can be made it is deferred: done when it is asked for.
  ended_ = std::async(std::launch::async | std::launch::deferred, [this] {
    Status done = Guarded([this] { return Persist(store_, batch_, cached_, put_, clock_.Now()); });
    if (done || done.error().code != ErrorCode::kUnreachable) put_.clear();
    is_done_ = true;
    done_();
    return done;
  });
}

std::optional<Status> DurableCommit::Finish(bool waits) {
  if (!Runs()) return std::nullopt;
  const bool is_running = !is_done_ && ended_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout;
  if (is_running && !waits) return std::nullopt;
  return ended_.get();
}

SessionCommits::SessionCommits(storage::Store& store, OpenSessions& sessions, SessionReceipts& receipts,
                               const Callbacks& callbacks, const Clock& clock, std::function<void()> done)
    : sessions_(sessions), receipts_(receipts), callbacks_(callbacks), commit_(store, clock, std::move(done)) {}

std::int64_t SessionCommits::PendingBytes() const {
  std::int64_t bytes = 0;
  for (const FinishedPayload& one : finished_) bytes += one.size_bytes;
  return bytes;
}

void SessionCommits::Start() {
  if (commit_.Runs() || finished_.empty() || IsHeldUp()) return;
  DurableBatch batch;
  batch.bytes = PendingBytes();
  for (const FinishedPayload& one : finished_) {
    batch.files.push_back({one.path, one.digest});
    for (const std::uint32_t idx : sessions_.At(one.session).WithSameContent(one.payload_idx))
      batch.held[one.session].insert(idx);
  }
  for (const auto& [session, idx] : batch.held)
    if (sessions_.At(session).Completes(idx)) batch.closing.insert(session);
  commit_.Start(std::move(batch));
  committing_ = std::exchange(finished_, {});
}

void SessionCommits::Finish(bool waits) {
  const std::optional<Status> done = commit_.Finish(waits);
  if (!done) return;
  if (*done)
    Announce(commit_.batch());
  else if (done->error().code == ErrorCode::kUnreachable)
    HoldUp(done->error());
  else
    GiveUp(commit_.batch(), done->error());
}

// Clients wait for their receipts meanwhile: what is not receipted fills their windows.
void SessionCommits::HoldUp(const Error& error) {
  LogWarn("received files wait for their receipts: " + Sentence(error));
  finished_.insert(finished_.begin(), std::make_move_iterator(committing_.begin()),
                   std::make_move_iterator(committing_.end()));
  again_at_ = std::chrono::steady_clock::now() + kHeldUpFor;
}

void SessionCommits::CommitDue() {
  // A bucket may take longer than thread W may stand still; windows bound what waits for it.
  Finish(PendingBytes() >= kCommitBytes && !commit_.IsIntoBucket());
  Start();
}

void SessionCommits::Settle() {
  Finish(true);
  Start();
  Finish(true);
}

void SessionCommits::Remove(const SessionId& session) {
  std::erase_if(finished_, [&](const FinishedPayload& one) { return one.session == session; });
  sessions_.Remove(session);
}

void SessionCommits::GiveUp(const RobotId& robot, const SessionId& session, const Error& error) {
  Finish(true);  // it may be at files of this session
  Remove(session);
  receipts_.Refuse(robot, session, error);
}

// Work is announced before the receipt: who has the receipt may count on it.
void SessionCommits::Announce(const DurableBatch& batch) {
  metrics::NoteReceived(batch.bytes);
  for (const auto& [session, idx] : batch.held) {
    const Status told = Guarded([&, &session = session, &idx = idx]() -> Status {
      AnnounceHeld(session, idx);
      return {};
    });
    // It is on disk: its client asks again, and is told what is stored.
    if (!told) OnceThereIsMemory([&, &session = session] { Remove(session); });
    if (!told) LogError(told.error());
  }
}

void SessionCommits::AnnounceHeld(const SessionId& session, const std::set<std::uint32_t>& payload_idx) {
  SessionIntake& intake = sessions_.At(session);
  intake.MarkHeld({payload_idx.begin(), payload_idx.end()});
  const bool is_closed = intake.AllHeld();
  const auto state = is_closed ? wire::ReceiptState::kClosed : wire::ReceiptState::kReceiving;
  if (is_closed) callbacks_.work_arrived(intake.robot());
  const RobotId robot = intake.robot();
  LogHeld(intake, state);
  if (is_closed) NoteReceive(intake, false);
  wire::Receipt receipt = receipts_.ReceiptOf(intake, state);
  if (is_closed) Remove(session);
  receipts_.Send(robot, std::move(receipt));
}

// Nothing of it was receipted: the client is told and starts from what is held.
void SessionCommits::GiveUp(const DurableBatch& batch, const Error& error) {
  LogError(error);
  for (const auto& [session, idx] : batch.held) {
    const RobotId robot = OnceThereIsMemory([&, &session = session] {
      NoteReceive(sessions_.At(session), true);
      return sessions_.At(session).robot();
    });
    OnceThereIsMemory([&, &session = session] { GiveUp(robot, session, error); });
  }
}

}  // namespace rigcal::dds
