// After a push: waits for what the server makes of it, from events and, so that nothing is missed when the server is
// restarted, from a question a second.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "client/wire/connection.h"
#include "client/wire/push_engine.h"

namespace rigcal::client {

struct AwaitHooks {
  std::function<void(const Document& edge)> on_edge;  // each edge once
  std::function<void(const std::string&)> say;
  // How many pairs of the session are calibrated, of all; several times a second, once the server has told it.
  std::function<void(std::int64_t done, std::int64_t total)> on_pairs = {};
};

struct AwaitPlace {
  RobotId robot;
  SessionId session;            // empty: of a batch of finished edges, or of an order
  std::set<std::string> edges;  // that the revision must hold; a session's are added as they come
  std::int64_t standing = 0;    // that the revision must count (docs/api.md); a session's own is added as it is known
  std::string where;
  std::int64_t give_up_ns = 60'000'000'000;
  std::int64_t policy = 0;  // version of the robot's own that must have judged the revision
};

struct Awaited {
  bool has_revision = false;  // false: the session has no sensor pairs, so there is none to wait for
  Document show;              // docs/api.md, show: a revision that holds all the edges
  std::string show_text;      // the same, verbatim
  Document status;
  Document session;                               // its row, where a session was waited for
  Document retired_sensors = {};                  // of those that it lists
  std::int64_t good_pairs = 0, failed_pairs = 0;  // of that session
  bool report_is_drawn = true;                    // else its page comes later
};

// Open before the push begins: no event is missed.
class ResultWatch {
 public:
  // Asks and listens in the robot's partition. The error is of DDS.
  [[nodiscard]] static Result<ResultWatch> Open(const wire::Participant& participant,
                                                const wire::ParticipantOptions& dds, const RobotId& robot);
  // kUnreachable if no server answered for give_up_ns, or if two are there.
  [[nodiscard]] Result<Awaited> Await(AwaitPlace place, const AwaitHooks& hooks);
  // For what is asked before the push.
  [[nodiscard]] Connection& connection() { return connection_; }

 private:
  ResultWatch(Connection connection, wire::Reader<rigcal_wire_Event> events, wire::WaitSet waitset);
  struct State;
  void TakeEvent(const rigcal_wire_Event& event, State& state) const;
  [[nodiscard]] Status AskSession(State& state);
  [[nodiscard]] Status AskRevision(State& state);
  [[nodiscard]] Status LookAt(std::int64_t newest, State& state);
  [[nodiscard]] Status AskAll(State& state);
  [[nodiscard]] Status AwaitPublished(State& state);
  [[nodiscard]] Status TakeEvents(State& state, std::chrono::milliseconds timeout);
  static void NoteEdge(const Document& edge, State& state);

  Connection connection_;
  wire::Reader<rigcal_wire_Event> events_;
  wire::WaitSet waitset_;
};

}  // namespace rigcal::client
