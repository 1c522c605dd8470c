#include "server/dds/record/session_receipts.h"

#include <algorithm>

#include "server/base/limits_in_force.h"
#include "server/dds/tell/receipts.h"
#include "storage/sessions/sessions.h"

namespace rigcal::dds {

// Many sessions at once share what the intake can hold.
std::int64_t SessionReceipts::WindowBytes() const {
  const auto sessions = static_cast<std::int64_t>(std::max<std::size_t>(sessions_.Count(), 1));
  const auto chunk_bytes = static_cast<std::int64_t>(limits::kChunkBytesMax);
  const limits::Limits& limits = limits::InForce();
  return std::clamp(limits.intake_bytes / sessions, 2 * chunk_bytes, limits.window_bytes);
}

wire::Receipt SessionReceipts::ReceiptOf(const SessionIntake& intake, wire::ReceiptState state) const {
  return intake.ReceiptOf(state, WindowBytes());
}

void SessionReceipts::SendState(const RobotId& robot, const SessionId& session, wire::ReceiptState state) {
  wire::Receipt receipt;
  receipt.robot = robot;
  receipt.subject_id = session.str();
  receipt.state = state;
  receipt.incarnation = sessions_.incarnation();
  receipt.window_bytes = static_cast<std::uint64_t>(WindowBytes());
  if (state == wire::ReceiptState::kClosed) {
    auto held = storage::LoadHeld(store_, session);
    if (!held) return Refuse(robot, session, held.error());
    receipt.held = std::move(*held);
    LogReceipt({.robot = robot.str(), .session = session.str()}, state,
               "robot " + robot.str() + ", session " + session.str() + ": all of it is on disk already");
  }
  outbox_.Send(robot, std::move(receipt));
}

void SessionReceipts::Refuse(const RobotId& robot, const SessionId& session, const Error& error) {
  LogRefusal({.robot = robot.str(), .session = session.str()},
             "robot " + robot.str() + ", session " + session.str() + " refused: ", error);
  outbox_.Send(robot, RefusalReceipt(robot, session.str(), sessions_.incarnation(), error));
}

}  // namespace rigcal::dds
