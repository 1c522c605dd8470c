// The second half of SessionRecorder: commits and receipts.
#include <algorithm>

#include "server/base/limits_in_force.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/dds/record/server_side.h"
#include "server/dds/record/session_recorder.h"
#include "server/dds/tell/receipt_log.h"
#include "server/metrics/noted.h"
#include "storage/sessions/sessions.h"

namespace rigcal::dds {
namespace {

void NoteReceive(const SessionIntake& intake, bool failed) {
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - intake.began_at;
  metrics::Note({metrics::Stage::kReceive, took.count(), failed});
}

}  // namespace

std::int64_t SessionRecorder::PendingBytes() const {
  std::int64_t bytes = 0;
  for (const Finished& one : finished_) bytes += one.size_bytes;
  return bytes;
}

// The files go on a thread of their own: meanwhile this one takes and writes the next.
void SessionRecorder::StartCommit() {
  if (commit_.valid() || finished_.empty()) return;
  running_ = {};
  running_bytes_ = PendingBytes();
  for (const Finished& one : finished_) {
    running_.files.push_back({one.path, one.digest});
    for (const std::uint32_t idx : intakes_.at(one.session)->WithSameContent(one.payload_idx))
      running_.held[one.session].insert(idx);
  }
  for (const auto& [session, idx] : running_.held)
    if (intakes_.at(session)->Completes(idx)) running_.closing.insert(session);
  commit_is_done_ = false;
  // Where no thread can be made it is deferred: done when it is asked for.
  commit_ = std::async(std::launch::async | std::launch::deferred, [this] {
    Status done = Guarded([this] { return Persist(commit_store_, running_, cached_, clock_.Now()); });
    commit_is_done_ = true;
    commit_done_();
    return done;
  });
  finished_.clear();
}

void SessionRecorder::FinishCommit(Patience patience) {
  if (!commit_.valid()) return;
  const bool is_running = !commit_is_done_ && commit_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout;
  if (is_running && patience == Patience::kNone) return;
  if (const Status done = commit_.get(); done) {
    Announce(running_);
  } else {
    GiveUp(running_, done.error());
  }
}

void SessionRecorder::Settle() {
  FinishCommit(Patience::kAll);
  StartCommit();
  FinishCommit(Patience::kAll);
}

// Work is announced before the receipt: who has the receipt may count on it.
void SessionRecorder::Announce(const DurableBatch& batch) {
  metrics::NoteReceived(running_bytes_);
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

void SessionRecorder::AnnounceHeld(const SessionId& session, const std::set<std::uint32_t>& payload_idx) {
  SessionIntake& intake = *intakes_.at(session);
  intake.MarkHeld({payload_idx.begin(), payload_idx.end()});
  const bool is_closed = intake.AllHeld();
  if (is_closed) callbacks_.work_arrived(intake.robot());
  const RobotId robot = intake.robot();
  LogHeld(intake, is_closed);
  if (is_closed) NoteReceive(intake, false);
  wire::Receipt receipt =
      intake.ReceiptOf(is_closed ? wire::ReceiptState::kClosed : wire::ReceiptState::kReceiving, WindowBytes());
  if (is_closed) Remove(session);
  outbox_.Send(robot, std::move(receipt));
}

void SessionRecorder::LogHeld(const SessionIntake& intake, bool is_closed) const {
  const std::string robot = intake.robot().str(), session = intake.session().str();
  LogReceipt({.robot = robot, .session = session},
             is_closed ? wire::ReceiptState::kClosed : wire::ReceiptState::kReceiving,
             "robot " + robot + ", session " + session +
                 (is_closed ? ": received, all of it is on disk" : ": a part of it is on disk"));
}

// Nothing of it was receipted: the client is told and starts from what is held.
void SessionRecorder::GiveUp(const DurableBatch& batch, const Error& error) {
  LogError(error);
  for (const auto& [session, idx] : batch.held) {
    const RobotId robot = OnceThereIsMemory([&, &session = session] {
      NoteReceive(*intakes_.at(session), true);
      return intakes_.at(session)->robot();
    });
    OnceThereIsMemory([&, &session = session] { GiveUp(robot, session, error); });
  }
}

// Many sessions at once share what the intake can hold.
std::int64_t SessionRecorder::WindowBytes() const {
  const auto sessions = static_cast<std::int64_t>(std::max<std::size_t>(intakes_.size(), 1));
  const auto chunk_bytes = static_cast<std::int64_t>(limits::kChunkBytesMax);
  const limits::Limits& limits = limits::InForce();
  return std::clamp(limits.intake_bytes / sessions, 2 * chunk_bytes, limits.window_bytes);
}

void SessionRecorder::SendState(const RobotId& robot, const SessionId& session, wire::ReceiptState state) {
  wire::Receipt receipt;
  receipt.robot = robot;
  receipt.subject_id = session.str();
  receipt.state = state;
  receipt.incarnation = incarnation_;
  receipt.window_bytes = static_cast<std::uint64_t>(WindowBytes());
  if (state == wire::ReceiptState::kClosed) {
    auto held = storage::LoadHeld(store_, session);
    if (!held) return SendRefusal(robot, session, held.error());
    receipt.held = std::move(*held);
    LogReceipt({.robot = robot.str(), .session = session.str()}, state,
               "robot " + robot.str() + ", session " + session.str() + ": all of it is on disk already");
  }
  outbox_.Send(robot, std::move(receipt));
}

void SessionRecorder::SendRefusal(const RobotId& robot, const SessionId& session, const Error& error) {
  LogRefusal({.robot = robot.str(), .session = session.str()},
             "robot " + robot.str() + ", session " + session.str() + " refused: ", error);
  wire::Receipt receipt;
  receipt.robot = robot;
  receipt.subject_id = session.str();
  receipt.state = wire::ReceiptState::kRefused;
  receipt.incarnation = incarnation_;
  receipt.error = ToldToClient(error);
  outbox_.Send(robot, std::move(receipt));
}

}  // namespace rigcal::dds
