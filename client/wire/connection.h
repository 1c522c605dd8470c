// Questions to the server: one Request, its Reply in parts. One thread.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "client/text/document.h"
#include "client/wire/one_server.h"
#include "client/wire/reply_parts.h"
#include "idl/dds.h"

namespace rigcal::client {

class Connection {
 public:
  // Does not wait for a server: Ask does.
  [[nodiscard]] static Result<Connection> Open(const wire::Participant& participant,
                                               const wire::ParticipantOptions& options);
  // The /api/v1 document of (verb, json), verbatim. kUnreachable if nobody answers in time, or if two servers are
  // there; the error that the document carries, if it is one.
  [[nodiscard]] Result<std::string> Ask(const std::string& verb, const std::string& json,
                                        std::chrono::milliseconds timeout);
  [[nodiscard]] Result<Document> AskDocument(const std::string& verb, const std::string& json,
                                             std::chrono::milliseconds timeout);
  // Until both directions are matched with a server, or, in a partition of one's own, the way there; kUnreachable after
  // the timeout.
  [[nodiscard]] Status WaitForServer(std::chrono::milliseconds timeout);
  // kUnreachable if two servers are there.
  [[nodiscard]] Status CheckOneServer() { return one_server_.Check(); }

 private:
  using Clock = std::chrono::steady_clock;
  Connection(wire::Writer<rigcal_wire_Request> requests, wire::Reader<rigcal_wire_Reply> replies, wire::WaitSet waitset,
             OneServer one_server, std::string where, bool is_met_first);
  [[nodiscard]] tl::unexpected<Error> Unreachable(std::chrono::milliseconds timeout) const;
  [[nodiscard]] Status Send(const std::string& verb, const std::string& json);
  [[nodiscard]] Result<std::optional<std::string>> TakeReply();

  wire::Writer<rigcal_wire_Request> requests_;
  wire::Reader<rigcal_wire_Reply> replies_;
  wire::WaitSet waitset_;
  OneServer one_server_;
  std::string where_;                        // "DDS domain 0, tag 'x'"
  bool is_met_first_;                        // the server replies in this partition before anybody asks there
  std::map<std::string, ReplyParts> asked_;  // by id, of the running Ask
};

// "DDS domain 3, tag 'bench'": where these options, and the environment that overrides them, look for a server.
[[nodiscard]] std::string WhereText(const wire::ParticipantOptions& options);
[[nodiscard]] Error UnreachableError(const std::string& where, std::chrono::milliseconds waited);
// One that was met and does not answer: not the same as none.
[[nodiscard]] Error BusyError(const std::string& where, std::chrono::milliseconds waited);

}  // namespace rigcal::client
