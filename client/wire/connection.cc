#include "client/wire/connection.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <random>

#include "client/text/table.h"
#include "idl/convert.h"
#include "idl/security.h"
#include "server/formats/answers/answers.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;

// The first question may reach the server's host before its reader knows our writer. It is asked again, under a new id
// so that the parts of two answers never mix.
constexpr std::array<milliseconds, 3> kAskAgainAfter = {milliseconds(60), milliseconds(500), milliseconds(2000)};

std::string RandomId() {
  std::random_device random;
  std::string id;
  for (int word = 0; word < 4; ++word) {
    std::array<char, 9> hex{};
    std::snprintf(hex.data(), hex.size(), "%08x", random());
    id += hex.data();
  }
  return id;
}

milliseconds Left(std::chrono::steady_clock::time_point deadline) {
  const auto left = std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now());
  return std::max(left, milliseconds(0));
}

}  // namespace

std::string WhereText(const wire::ParticipantOptions& options) {
  const char* domain = std::getenv("RIGCAL_DOMAIN");
  const char* tag_variable = std::getenv("RIGCAL_DDS_TAG");
  const std::string tag = options.tag.empty() && tag_variable != nullptr ? tag_variable : options.tag;
  const std::string where = "DDS domain " + (domain && *domain ? std::string(domain) : std::to_string(options.domain));
  const std::filesystem::path identity = wire::IdentityFolder(options.identity);
  return where + (tag.empty() ? "" : ", tag '" + tag + "'") +
         (identity.empty() ? "" : ", with the identity in " + identity.string());
}

Error UnreachableError(const std::string& where, milliseconds waited) {
  const bool is_secured = !wire::IdentityFolder({}).empty();
  return {ErrorCode::kUnreachable,
          "no rigcald answers on " + where + " (waited " + Fixed(static_cast<double>(waited.count()) * 1e-3, 1) + " s)",
          is_secured
              ? "Start it with an identity of the same authority (`rigcald --dds-identity DIR`); if it runs, its "
                "log says whom it refuses, as revoked or expired"
              : "Start it with `rigcald --data DIR`, or run `rigcal doctor` to see what is in the way; where it has an "
                "identity, give yours (--dds-identity)"};
}

Error BusyError(const std::string& where, milliseconds waited) {
  return {ErrorCode::kUnreachable,
          "the rigcald on " + where + " is there, but did not answer within " +
              Fixed(static_cast<double>(waited.count()) * 1e-3, 1) + " s",
          "It is busy: ask again, or wait longer with --timeout"};
}

Connection::Connection(wire::Writer<rigcal_wire_Request> requests, wire::Reader<rigcal_wire_Reply> replies,
                       wire::WaitSet waitset, OneServer one_server, std::string where, bool is_met_first)
    : requests_(std::move(requests)),
      replies_(std::move(replies)),
      waitset_(std::move(waitset)),
      one_server_(std::move(one_server)),
      where_(std::move(where)),
      is_met_first_(is_met_first) {}

Result<Connection> Connection::Open(const wire::Participant& participant, const wire::ParticipantOptions& options) {
  const std::vector<std::string> partition = {participant.AskPartition()};
  RIGCAL_ASSIGN(auto requests, wire::Writer<rigcal_wire_Request>::Open(participant, partition));
  RIGCAL_ASSIGN(auto replies, wire::Reader<rigcal_wire_Reply>::Open(participant, partition));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(replies.get()));
  RIGCAL_TRY(waitset.Attach(requests.get()));
  RIGCAL_ASSIGN(auto one_server, OneServer::Open(participant, WhereText(options)));
  return Connection(std::move(requests), std::move(replies), std::move(waitset), std::move(one_server),
                    WhereText(options), partition.front() == wire::kOperatorPartition);
}

tl::unexpected<Error> Connection::Unreachable(milliseconds timeout) const {
  return Fail(UnreachableError(where_, timeout));
}

Status Connection::WaitForServer(milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  while (requests_.MatchedReaders() == 0 || (is_met_first_ && replies_.MatchedWriters() == 0)) {
    if (Left(deadline).count() == 0) return Unreachable(timeout);
    RIGCAL_TRY(waitset_.Wait(Left(deadline)));
  }
  return {};
}

Status Connection::Send(const std::string& verb, const std::string& json) {
  const std::string id = RandomId();
  asked_.emplace(id, ReplyParts());
  rigcal_wire_Request request{};
  RIGCAL_TRY(wire::CopyText(id, request.id, sizeof(request.id), "request id"));
  RIGCAL_TRY(wire::CopyText(verb, request.verb, sizeof(request.verb), "verb"));
  std::string body = json;
  request.json = body.data();
  return requests_.Write(request);
}

Result<std::optional<std::string>> Connection::TakeReply() {
  std::optional<std::string> whole;
  RIGCAL_TRY(replies_.Take(64, [&](const rigcal_wire_Reply& reply, const wire::SampleOrigin&) {
    const auto mine = asked_.find(reply.id);
    if (mine == asked_.end() || whole) return;
    whole = mine->second.Add(reply.part_idx, reply.part_count, reply.json);
  }));
  return whole;
}

Result<std::string> Connection::Ask(const std::string& verb, const std::string& json, milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  asked_.clear();
  RIGCAL_TRY(WaitForServer(timeout));
  RIGCAL_TRY(CheckOneServer());
  std::size_t attempt = 0;
  auto ask_at = Clock::now();
  while (true) {
    if (Clock::now() >= ask_at) {
      RIGCAL_TRY(Send(verb, json));
      ask_at = Clock::now() + kAskAgainAfter[std::min(attempt++, kAskAgainAfter.size() - 1)];
    }
    RIGCAL_TRY(waitset_.Wait(std::min(Left(ask_at), Left(deadline))));
    RIGCAL_ASSIGN(auto whole, TakeReply());
    if (whole) {
      RIGCAL_TRY(CheckOneServer());
      if (auto error = formats::ReadError(*whole)) return Fail(std::move(*error));
      return std::move(*whole);
    }
    if (Left(deadline).count() == 0)
      return requests_.MatchedReaders() > 0 ? Fail(BusyError(where_, timeout)) : Unreachable(timeout);
  }
}

Result<Document> Connection::AskDocument(const std::string& verb, const std::string& json, milliseconds timeout) {
  RIGCAL_ASSIGN(const std::string text, Ask(verb, json, timeout));
  return Document::Parse(text, "the server's answer to '" + verb + "'");
}

}  // namespace rigcal::client
