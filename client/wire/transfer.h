// Runs a PushEngine against the server: its actions become samples, receipts come back. One thread, no sleeps.
#pragma once

#include <functional>
#include <string>

#include "client/wire/push_engine.h"
#include "idl/dds.h"

namespace rigcal::client {

// What an engine's actions mean on the wire.
class Outlet {
 public:
  Outlet() = default;
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;
  virtual ~Outlet() = default;
  // Asks the server where it stands.
  [[nodiscard]] virtual Status SendHeader(const PushEngine& engine) = 0;
  // Once the server wants it.
  [[nodiscard]] virtual Status SendManifest() = 0;
  [[nodiscard]] virtual Status SendChunk(const ChunkAt& chunk) = 0;  // kBusy: not sent
  // The server complained about a payload: is it our input that changed?
  [[nodiscard]] virtual Status CheckInput() const = 0;
  // A server's readers are there for all writers.
  [[nodiscard]] virtual bool HasServer() const = 0;
  // Writers whose matches should wake the wait.
  [[nodiscard]] virtual std::vector<dds_entity_t> Writers() const = 0;
};

// What a person is told on the way.
struct TransferHooks {
  std::function<void(const PushEngine&, std::int64_t now_ns)> on_tick;  // once a server has answered
  std::function<void(const std::string&)> say;
};

struct TransferPlace {
  RobotId robot;
  std::string subject_id;  // session or batch
  std::string where;       // WhereText
};

// Of a clock that never goes back; its zero means nothing.
[[nodiscard]] std::int64_t SteadyNow_ns();

// Until the subject is closed. Errors: refused (the server's sentence), kUnreachable after the plan's give_up_ns or
// if two servers are there.
[[nodiscard]] Status RunTransfer(const wire::Participant& participant, const TransferPlace& place, PushEngine& engine,
                                 Outlet& outlet, const TransferHooks& hooks);

}  // namespace rigcal::client
