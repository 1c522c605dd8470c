#include "server/dds/record/session_recorder.h"

#include <algorithm>

#include "server/base/limits_in_force.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/parallel_for.h"
#include "server/base/version.h"
#include "server/formats/documents.h"
#include "server/model/edges/admission.h"
#include "storage/files/blobs.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"

namespace rigcal::dds {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kOpenPayloadsMax = 1'000'000;  // of all sessions that are being received: bounds memory

Error WrongHash(const std::string& path) {
  return {ErrorCode::kConflict, path + ": its bytes do not have the hash that the manifest gives",
          "Leave the session's files alone while they are pushed; push the folder again"};
}

}  // namespace

SessionRecorder::SessionRecorder(storage::Store& store, storage::Store& commit_store, const std::string& intake,
                                 Outbox& outbox, const Callbacks& callbacks, const Clock& clock,
                                 std::uint64_t incarnation, std::function<void()> commit_done)
    : store_(store),
      commit_store_(commit_store),
      folder_(intake.empty() ? store.IntakeFolder() : store.IntakeFolder() / intake),
      outbox_(outbox),
      callbacks_(callbacks),
      clock_(clock),
      incarnation_(incarnation),
      commit_done_(std::move(commit_done)),
      cached_(limits::kCachedBytes) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) fs::remove_all(entry.path(), ignored);
}

SessionIntake* SessionRecorder::Find(const SessionId& session) {
  const auto found = intakes_.find(session);
  if (found == intakes_.end()) return nullptr;
  found->second->last_used = ++uses_;
  return found->second.get();
}

Result<wire::ReceiptState> SessionRecorder::Open(const RobotId& robot, const SessionId& session) {
  const SessionIntake* known = Find(session);
  RIGCAL_ASSIGN(const auto row, storage::LoadSession(store_, session));
  if (!row) return wire::ReceiptState::kNeedManifest;
  if (row->robot != robot)
    return Fail(ErrorCode::kConflict, "session " + session.str() + " belongs to robot " + row->robot.str(),
                "Name that robot in session.yaml, or push it as the robot that recorded it");
  const bool is_whole = row->payloads_held >= row->payloads;  // a closed one may have lost some since
  if (row->closed && is_whole) return wire::ReceiptState::kClosed;
  if (known != nullptr) return wire::ReceiptState::kReceiving;
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store_, session));
  if (!manifest)
    return Fail(ErrorCode::kStorage, "session " + session.str() + " has no manifest", "Run `rigcal doctor`");
  RIGCAL_TRY(AddIntake(robot, session, *manifest));
  return wire::ReceiptState::kReceiving;
}

void SessionRecorder::MakeRoom(std::size_t payloads) {
  const auto sessions_max = static_cast<std::size_t>(limits::InForce().open_sessions);
  while (!intakes_.empty() && (intakes_.size() >= sessions_max || open_payloads_ + payloads > kOpenPayloadsMax)) {
    const auto later = [](const auto& a, const auto& b) { return a.second->last_used < b.second->last_used; };
    const SessionId oldest = std::min_element(intakes_.begin(), intakes_.end(), later)->first;
    Settle();  // complete files of that session are not wasted
    Remove(oldest);
  }
}

// A session that comes back after this must send again what is not held: for it the server is a new one.
void SessionRecorder::Remove(const SessionId& session) {
  const auto found = intakes_.find(session);
  if (found == intakes_.end()) return;
  std::error_code ignored;
  fs::remove_all(found->second->folder(), ignored);
  open_payloads_ -= found->second->payloads();
  const auto is_its = [&](const Finished& one) { return one.session == session; };
  finished_.erase(std::remove_if(finished_.begin(), finished_.end(), is_its), finished_.end());
  if (!found->second->AllHeld()) ++incarnation_;
  intakes_.erase(found);
  open_sessions_ = intakes_.size();
  dirty_.erase(session);
}

Result<SessionIntake*> SessionRecorder::AddIntake(const RobotId& robot, const SessionId& session,
                                                  const Manifest& manifest) {
  MakeRoom(manifest.payloads.size());
  RIGCAL_ASSIGN(const std::vector<bool> held, storage::LoadHeld(store_, session));
  const fs::path folder = folder_ / session.str();
  std::error_code code;
  fs::create_directories(folder, code);
  if (code)
    return Fail(ErrorCode::kStorage, folder.string() + ": cannot be made (" + code.message() + ")",
                "Check that the disk has free space and that the server may write to it");
  auto intake = std::make_unique<SessionIntake>(robot, session, manifest, held, folder, incarnation_);
  intake->last_used = ++uses_;
  open_payloads_ += intake->payloads();
  SessionIntake* added = intakes_.emplace(session, std::move(intake)).first->second.get();
  open_sessions_ = intakes_.size();
  return added;
}

void SessionRecorder::Take(const OpenSession& open) {
  if (open.protocol > kWireProtocol)
    return SendRefusal(open.robot, open.session,
                       {ErrorCode::kUnsupported,
                        "the client speaks protocol " + std::to_string(open.protocol) + ", this server " +
                            std::to_string(kWireProtocol),
                        "Update rigcald, or push with an older rigcal"});
  const auto state = Open(open.robot, open.session);
  if (state && *state == wire::ReceiptState::kClosed)
    if (const Status again = PushAgain(open.robot, open.session); !again)
      return SendRefusal(open.robot, open.session, again.error());
  Tell(open.robot, open.session, state);
}

// The newest push counts: a closed session that was superseded is current again.
Status SessionRecorder::PushAgain(const RobotId& robot, const SessionId& session) {
  RIGCAL_ASSIGN(const bool changed, storage::MakeCurrent(store_, session, storage::MadeCurrent::kPushedAgain,
                                                         {clock_.Now(), "robot " + robot.str(), ""}));
  if (changed) callbacks_.work_arrived(robot);
  return {};
}

// Where the session stands, for its client; of one that is received with the next report.
void SessionRecorder::Tell(const RobotId& robot, const SessionId& session, const Result<wire::ReceiptState>& state) {
  if (!state) return SendRefusal(robot, session, state.error());
  if (*state == wire::ReceiptState::kReceiving) {
    dirty_.insert(session);
  } else {
    SendState(robot, session, *state);
  }
}

// Payloads that this robot sent before, in another session, need not travel. True if nothing is missing then.
Result<bool> SessionRecorder::StoreHeldElsewhere(const SessionId& session, const Manifest& manifest) {
  std::vector<std::uint32_t> held;
  for (std::uint32_t i = 0; i < manifest.payloads.size(); ++i) {
    const Digest& digest = manifest.payloads[i].digest;
    RIGCAL_ASSIGN(const bool is_held, storage::IsHeld(store_, manifest.header.robot, digest));
    if (is_held && storage::HasBlob(store_.BlobFolder(), digest)) held.push_back(i);
  }
  const Stamp now = clock_.Now();
  if (!held.empty()) RIGCAL_TRY(storage::AppendHeld(store_, session, held, now));
  if (held.size() < manifest.payloads.size()) return false;
  RIGCAL_TRY(storage::CloseSession(store_, session, PairsToCalibrate(manifest.header), now));
  return true;
}

Status SessionRecorder::StoreManifest(const ManifestText& text) {
  if (Sha256Of(text.bytes).str() != text.session.str())
    return Fail(ErrorCode::kInvalidInput, "the manifest of session " + text.session.str() + " has another hash",
                "Push the session again with `rigcal push`");
  RIGCAL_ASSIGN(const Manifest manifest, formats::ReadManifest(text.bytes));
  if (manifest.header.robot != text.robot)
    return Fail(
        ErrorCode::kInvalidInput,
        "the session names robot " + manifest.header.robot.str() + ", but robot " + text.robot.str() + " pushes it",
        "Push it as the robot that session.yaml names");
  RIGCAL_TRY(CheckAdmission(manifest, limits::InForce()));
  RIGCAL_TRY(CheckCapturedAt(manifest.header, clock_.Now()));
  bool closed = false;
  RIGCAL_TRY(store_.Write([&]() -> Status {
    RIGCAL_TRY(storage::AppendSession(store_, text.session, text.bytes, manifest, clock_.Now()));
    RIGCAL_ASSIGN(closed, StoreHeldElsewhere(text.session, manifest));
    return {};
  }));
  if (closed) callbacks_.work_arrived(text.robot);
  return {};
}

void SessionRecorder::Take(const ManifestText& text) {
  auto state = Open(text.robot, text.session);
  if (state && *state == wire::ReceiptState::kNeedManifest) {
    const Status stored = StoreManifest(text);
    state = stored ? Open(text.robot, text.session) : Result<wire::ReceiptState>(Fail(stored.error()));
  }
  Tell(text.robot, text.session, state);
}

// The open session of that robot; else the client is told where it stands.
SessionIntake* SessionRecorder::Prepare(const RobotId& robot, const SessionId& session) {
  SessionIntake* intake = Find(session);
  if (intake == nullptr || intake->robot() != robot) {
    Tell(robot, session, Open(robot, session));
    intake = Find(session);
  }
  if (intake == nullptr || intake->robot() != robot) return nullptr;
  dirty_.insert(session);
  return intake;
}

void SessionRecorder::Take(ChunkBytes& chunk) {
  if (SessionIntake* intake = Prepare(chunk.robot, chunk.session)) intake->Add(chunk);
}

void SessionRecorder::Take(const DiscardedChunk& chunk) {
  if (SessionIntake* intake = Prepare(chunk.robot, chunk.session)) intake->AddDiscarded(chunk);
}

void SessionRecorder::Complete(SessionIntake& intake, std::uint32_t payload_idx, const Result<Digest>& digest) {
  if (!digest) return intake.Drop(payload_idx, digest.error());
  const PartFile& part = intake.Part(payload_idx);
  if (*digest != intake.DigestOf(payload_idx)) {
    const auto manifest = storage::LoadManifest(store_, intake.session());
    const bool named = manifest && *manifest && payload_idx < (*manifest)->payloads.size();
    return intake.Drop(payload_idx, WrongHash(named ? (*manifest)->payloads[payload_idx].path
                                                    : "payload " + std::to_string(payload_idx)));
  }
  finished_.push_back(
      {intake.session(), payload_idx, part.path(), *digest, static_cast<std::int64_t>(part.size_bytes())});
  intake.MarkFinished(payload_idx);
}

void SessionRecorder::GiveUp(const RobotId& robot, const SessionId& session, const Error& error) {
  FinishCommit(Patience::kAll);  // it may be at files of this session
  Remove(session);
  SendRefusal(robot, session, error);
}

// What is thrown may have left any of them half written.
void SessionRecorder::Write() {
  const Status written = Guarded([&]() -> Status {
    WriteTouched();
    return {};
  });
  if (written) return;
  while (!dirty_.empty()) {
    const SessionId session = OnceThereIsMemory([&] { return *dirty_.begin(); });
    const RobotId robot = OnceThereIsMemory([&] { return intakes_.at(session)->robot(); });
    OnceThereIsMemory([&] { GiveUp(robot, session, written.error()); });
  }
}

void SessionRecorder::WriteTouched() {
  struct Work {
    SessionIntake* intake;
    std::uint32_t payload_idx;
    Status written;
    Result<Digest> digest;
  };
  std::vector<Work> work;
  for (const SessionId& session : dirty_)
    for (const std::uint32_t idx : intakes_.at(session)->TakeTouched())
      work.push_back({intakes_.at(session).get(), idx, {}, Digest()});
  ParallelFor(work.size(), [&](std::size_t i) {
    PartFile& part = work[i].intake->Part(work[i].payload_idx);
    work[i].written = part.Flush();
    if (work[i].written && part.Complete()) work[i].digest = part.Hash();
  });
  for (const Work& done : work) {
    const PartFile& part = done.intake->Part(done.payload_idx);
    if (!done.written) {
      done.intake->Drop(done.payload_idx, done.written.error());
    } else if (part.Complete()) {
      Complete(*done.intake, done.payload_idx, done.digest);
    } else if (part.Shattered()) {
      done.intake->Drop(done.payload_idx, {ErrorCode::kInvalidInput, "a payload came in too many pieces",
                                           "Send it in order, in chunks of up to 1 MiB"});
    }
  }
}

// Who hears nothing asks again.
void SessionRecorder::Report() {
  const Status reported = Guarded([&]() -> Status {
    ReportAll();
    return {};
  });
  if (!reported) LogError(reported.error());
  dirty_.clear();
}

void SessionRecorder::ReportAll() {
  for (const SessionId& session : dirty_) {
    const SessionIntake& intake = *intakes_.at(session);
    outbox_.Send(intake.robot(), intake.ReceiptOf(wire::ReceiptState::kReceiving, WindowBytes()));
  }
}

}  // namespace rigcal::dds
