// What the clients of sessions are told: where theirs stands, how far it is, why it is refused. Thread W only.
#pragma once

#include "server/dds/record/open_sessions.h"
#include "server/dds/tell/outbox.h"
#include "storage/store.h"

namespace rigcal::dds {

class SessionReceipts {
 public:
  // All outlive it.
  SessionReceipts(storage::Store& store, const OpenSessions& sessions, Outbox& outbox)
      : store_(store), sessions_(sessions), outbox_(outbox) {}

  // Of a session that is not being received.
  void SendState(const RobotId& robot, const SessionId& session, wire::ReceiptState state);
  // How far one is that is being received: `state` kReceiving, or kClosed with the last of it.
  [[nodiscard]] wire::Receipt ReceiptOf(const SessionIntake& intake, wire::ReceiptState state) const;
  void Send(const RobotId& robot, wire::Receipt receipt) { outbox_.Send(robot, std::move(receipt)); }
  void Refuse(const RobotId& robot, const SessionId& session, const Error& error);

 private:
  [[nodiscard]] std::int64_t WindowBytes() const;

  storage::Store& store_;
  const OpenSessions& sessions_;
  Outbox& outbox_;
};

}  // namespace rigcal::dds
