#include "server/dds/record/session_recorder.h"

#include "server/base/limits_in_force.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/parallel_for.h"
#include "server/base/version.h"
#include "server/formats/documents.h"
#include "server/model/edges/admission.h"
#include "storage/files/held_files.h"
#include "storage/s3/store_bucket.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"
#include "storage/sites/superseded_there.h"

namespace rigcal::dds {
namespace {

Error WrongHash(const std::string& path) {
  return {ErrorCode::kConflict, path + ": its bytes do not have the hash that the manifest gives",
          "Leave the session's files alone while they are pushed; push the folder again"};
}

// Begins to receive it. The one that was used longest ago goes where there is no room; complete files of that are not
// wasted.
Status AddIntake(storage::Store& store, const RobotId& robot, const SessionId& session, const Manifest& manifest,
                 OpenSessions& sessions, SessionCommits& commits) {
  while (const auto oldest = sessions.InTheWayOf(manifest.payloads.size())) {
    commits.Settle();
    commits.Remove(*oldest);
  }
  RIGCAL_ASSIGN(const std::vector<bool> held, storage::LoadHeld(store, session));
  const auto added = sessions.Add(robot, session, manifest, held);
  return added ? Status() : Fail(added.error());
}

// Where the session stands by the rows; one that is stored in part is received from here on.
Result<wire::ReceiptState> Resume(storage::Store& store, const RobotId& robot, const SessionId& session,
                                  OpenSessions& sessions, SessionCommits& commits) {
  const SessionIntake* known = sessions.Find(session);
  RIGCAL_ASSIGN(const auto row, storage::LoadSession(store, session));
  if (!row) return wire::ReceiptState::kNeedManifest;
  if (row->robot != robot)
    return Fail(ErrorCode::kConflict, "session " + session.str() + " belongs to robot " + row->robot.str(),
                "Name that robot in session.yaml, or push it as the robot that recorded it");
  const bool is_whole = row->payloads_held >= row->payloads;  // a closed one may have lost some since
  if (row->closed && is_whole) return wire::ReceiptState::kClosed;
  if (known != nullptr) return wire::ReceiptState::kReceiving;
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, session));
  if (!manifest)
    return Fail(ErrorCode::kStorage, "session " + session.str() + " has no manifest", "Run `rigcal doctor`");
  RIGCAL_TRY(AddIntake(store, robot, session, *manifest, sessions, commits));
  return wire::ReceiptState::kReceiving;
}

// The same, but what the rows call held is held against the disk before. One that is being received begins anew where
// a part of that is lost: its client sends only what it was never told to be held.
Result<wire::ReceiptState> Open(storage::Store& store, const RobotId& robot, const SessionId& session,
                                OpenSessions& sessions, SessionCommits& commits, Stamp now) {
  RIGCAL_TRY(storage::NoteLostFiles(store, session, now));
  if (const SessionIntake* known = sessions.Find(session)) {
    RIGCAL_ASSIGN(const std::vector<bool> held, storage::LoadHeld(store, session));
    if (known->HoldsMoreThan(held)) {
      commits.Settle();
      commits.Remove(session);
    }
  }
  return Resume(store, robot, session, sessions, commits);
}

using PayloadIndices = std::vector<std::uint32_t>;

// Payloads that this robot sent before, in another session, and that are there: they need not travel. What a bucket
// does not say in time is sent again.
Result<PayloadIndices> FindHeldElsewhere(storage::Store& store, const Manifest& manifest, Stamp now) {
  PayloadIndices named;
  std::vector<storage::HeldFile> files;
  for (std::uint32_t i = 0; i < manifest.payloads.size(); ++i) {
    const Payload& payload = manifest.payloads[i];
    RIGCAL_ASSIGN(const bool is_held, storage::IsHeld(store, manifest.header.robot, payload.digest));
    if (!is_held) continue;
    named.push_back(i);
    files.push_back({payload.digest, payload.size_bytes});
  }
  RIGCAL_ASSIGN(const std::vector<storage::HeldState> states, storage::CheckHeld(store, files, now));
  PayloadIndices held;
  for (std::size_t i = 0; i < named.size(); ++i)
    if (states[i] == storage::HeldState::kKept) held.push_back(named[i]);
  return held;
}

// True if nothing is missing then. What was found to be lost meanwhile is sent again.
Result<bool> StoreHeldElsewhere(storage::Store& store, const SessionId& session, const Manifest& manifest,
                                const PayloadIndices& kept, Stamp now) {
  RIGCAL_TRY(storage::CheckBlobsStayed(store));
  PayloadIndices held;
  for (const std::uint32_t i : kept) {
    RIGCAL_ASSIGN(const bool is_held, storage::IsHeld(store, manifest.header.robot, manifest.payloads[i].digest));
    if (is_held) held.push_back(i);
  }
  if (!held.empty()) RIGCAL_TRY(storage::AppendHeld(store, session, held, now));
  if (held.size() < manifest.payloads.size()) return false;
  RIGCAL_TRY(storage::CloseSession(store, session, PairsToCalibrate(manifest.header), now));
  return true;
}

Result<Manifest> CheckedManifest(const ManifestText& text, Stamp now) {
  if (Sha256Of(text.bytes).str() != text.session.str())
    return Fail(ErrorCode::kInvalidInput, "the manifest of session " + text.session.str() + " has another hash",
                "Push the session again with `rigcal push`");
  RIGCAL_ASSIGN(Manifest manifest, formats::ReadManifest(text.bytes));
  if (manifest.header.robot != text.robot)
    return Fail(
        ErrorCode::kInvalidInput,
        "the session names robot " + manifest.header.robot.str() + ", but robot " + text.robot.str() + " pushes it",
        "Push it as the robot that session.yaml names");
  RIGCAL_TRY(CheckAdmission(manifest, limits::InForce()));
  RIGCAL_TRY(CheckCapturedAt(manifest.header, now));
  return manifest;
}

// True if nothing has to come any more: the session is closed.
Result<bool> StoreManifest(storage::Store& store, const ManifestText& text, const Clock& clock) {
  RIGCAL_ASSIGN(const Manifest manifest, CheckedManifest(text, clock.Now()));
  RIGCAL_ASSIGN(const PayloadIndices kept, FindHeldElsewhere(store, manifest, clock.Now()));
  bool closed = false;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_TRY(storage::AppendSession(store, text.session, text.bytes, manifest, clock.Now()));
    RIGCAL_TRY(storage::NoteSuperseding(store, text.session, text.superseded_by));
    RIGCAL_ASSIGN(closed, StoreHeldElsewhere(store, text.session, manifest, kept, clock.Now()));
    return {};
  }));
  return closed;
}

// A part of a payload that was added to, and what became of it.
struct Flushed {
  SessionIntake* intake;
  std::uint32_t payload_idx;
  Status written;
  Result<Digest> digest;
};

std::vector<Flushed> FlushAll(OpenSessions& sessions) {
  std::vector<Flushed> all;
  for (const SessionId& session : sessions.dirty())
    for (const std::uint32_t idx : sessions.At(session).TakeTouched())
      all.push_back({&sessions.At(session), idx, {}, Digest()});
  ParallelFor(all.size(), [&](std::size_t i) {
    PartFile& part = all[i].intake->Part(all[i].payload_idx);
    all[i].written = part.Flush();
    if (all[i].written && part.Complete()) all[i].digest = part.Hash();
  });
  return all;
}

void Complete(storage::Store& store, const Flushed& done, SessionCommits& commits) {
  SessionIntake& intake = *done.intake;
  const std::uint32_t payload_idx = done.payload_idx;
  if (!done.digest) return intake.Drop(payload_idx, done.digest.error());
  const PartFile& part = intake.Part(payload_idx);
  if (*done.digest != intake.DigestOf(payload_idx)) {
    const auto manifest = storage::LoadManifest(store, intake.session());
    const bool named = manifest && *manifest && payload_idx < (*manifest)->payloads.size();
    return intake.Drop(payload_idx, WrongHash(named ? (*manifest)->payloads[payload_idx].path
                                                    : "payload " + std::to_string(payload_idx)));
  }
  commits.Add({intake.session(), payload_idx, part.path(), *done.digest, static_cast<std::int64_t>(part.size_bytes())});
  intake.MarkFinished(payload_idx);
}

void WriteTouched(storage::Store& store, OpenSessions& sessions, SessionCommits& commits) {
  for (const Flushed& done : FlushAll(sessions)) {
    const PartFile& part = done.intake->Part(done.payload_idx);
    if (!done.written) {
      done.intake->Drop(done.payload_idx, done.written.error());
    } else if (part.Complete()) {
      Complete(store, done, commits);
    } else if (part.Shattered()) {
      done.intake->Drop(done.payload_idx, {ErrorCode::kInvalidInput, "a payload came in too many pieces",
                                           "Send it in order, in chunks of up to 1 MiB"});
    }
  }
}

}  // namespace

SessionRecorder::SessionRecorder(storage::Store& store, storage::Store& commit_store, const std::string& intake,
                                 Outbox& outbox, const Callbacks& callbacks, const Clock& clock,
                                 std::uint64_t incarnation, std::function<void()> commit_done)
    : store_(store),
      callbacks_(callbacks),
      clock_(clock),
      sessions_(intake.empty() ? store.IntakeFolder() : store.IntakeFolder() / intake, incarnation),
      receipts_(store, sessions_, outbox),
      commits_(commit_store, sessions_, receipts_, callbacks, clock, std::move(commit_done)) {}

// Of a closed session the newest push counts: one that was superseded is current again.
void SessionRecorder::Take(const OpenSession& open) {
  if (open.protocol > kWireProtocol)
    return receipts_.Refuse(open.robot, open.session,
                            {ErrorCode::kUnsupported,
                             "the client speaks protocol " + std::to_string(open.protocol) + ", this server " +
                                 std::to_string(kWireProtocol),
                             "Update rigcald, or push with an older rigcal"});
  const auto state = Open(store_, open.robot, open.session, sessions_, commits_, clock_.Now());
  if (state && *state == wire::ReceiptState::kClosed) {
    const auto changed = storage::MakeCurrent(store_, open.session, storage::MadeCurrent::kPushedAgain,
                                              {clock_.Now(), "robot " + open.robot.str(), ""});
    if (!changed) return receipts_.Refuse(open.robot, open.session, changed.error());
    if (*changed) callbacks_.work_arrived(open.robot);
  }
  Tell(open.robot, open.session, state);
}

// Where the session stands, for its client; of one that is received with the next report.
void SessionRecorder::Tell(const RobotId& robot, const SessionId& session, const Result<wire::ReceiptState>& state) {
  if (!state) return receipts_.Refuse(robot, session, state.error());
  if (*state == wire::ReceiptState::kReceiving)
    sessions_.dirty().insert(session);
  else
    receipts_.SendState(robot, session, *state);
}

void SessionRecorder::Take(const ManifestText& text) {
  auto state = Open(store_, text.robot, text.session, sessions_, commits_, clock_.Now());
  if (state && *state == wire::ReceiptState::kReceiving)
    if (const Status noted = storage::NoteSuperseding(store_, text.session, text.superseded_by); !noted)
      state = Fail(noted.error());
  if (state && *state == wire::ReceiptState::kNeedManifest) {
    const auto closed = StoreManifest(store_, text, clock_);
    if (closed && *closed) callbacks_.work_arrived(text.robot);
    state = closed ? Resume(store_, text.robot, text.session, sessions_, commits_) : Fail(closed.error());
  }
  Tell(text.robot, text.session, state);
}

// The open session of that robot; else the client is told where it stands.
SessionIntake* SessionRecorder::Prepare(const RobotId& robot, const SessionId& session) {
  SessionIntake* intake = sessions_.Find(session);
  if (intake == nullptr || intake->robot() != robot) {
    Tell(robot, session, Open(store_, robot, session, sessions_, commits_, clock_.Now()));
    intake = sessions_.Find(session);
  }
  if (intake == nullptr || intake->robot() != robot) return nullptr;
  sessions_.dirty().insert(session);
  return intake;
}

void SessionRecorder::Take(ChunkBytes& chunk) {
  if (SessionIntake* intake = Prepare(chunk.robot, chunk.session)) intake->Add(chunk);
}

void SessionRecorder::Take(const DiscardedChunk& chunk) {
  if (SessionIntake* intake = Prepare(chunk.robot, chunk.session)) intake->AddDiscarded(chunk);
}

// What is thrown may have left any of them half written.
void SessionRecorder::Write() {
  const Status written = Guarded([&]() -> Status {
    WriteTouched(store_, sessions_, commits_);
    return {};
  });
  if (written) return;
  while (!sessions_.dirty().empty()) {
    const SessionId session = OnceThereIsMemory([&] { return *sessions_.dirty().begin(); });
    const RobotId robot = OnceThereIsMemory([&] { return sessions_.At(session).robot(); });
    OnceThereIsMemory([&] { commits_.GiveUp(robot, session, written.error()); });
  }
}

// Who hears nothing asks again.
void SessionRecorder::Report() {
  const Status reported = Guarded([&]() -> Status {
    for (const SessionId& session : sessions_.dirty()) {
      const SessionIntake& intake = sessions_.At(session);
      receipts_.Send(intake.robot(), receipts_.ReceiptOf(intake, wire::ReceiptState::kReceiving));
    }
    return {};
  });
  if (!reported) LogError(reported.error());
  sessions_.dirty().clear();
}

}  // namespace rigcal::dds
