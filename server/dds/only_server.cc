#include "server/dds/only_server.h"

#include <unistd.h>

#include <array>
#include <random>
#include <thread>
#include <tuple>

namespace rigcal::dds {
namespace {

// Discovery answers a newcomer at once: in a few milliseconds here, and in a round trip from elsewhere. Who is heard of
// later is dealt with while both serve (Before).
constexpr std::chrono::milliseconds kHeardWithin{250};
// With identities each shows first who it is: some 0.4 s, and another second where one was not ready.
constexpr std::chrono::milliseconds kShownWithin{2000};

std::string HostName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 && name[0] != '\0' ? name.data() : "this host";
}

std::string NewServerId() {
  std::random_device random;
  std::array<char, 17> hex{};
  std::snprintf(hex.data(), hex.size(), "%08x%08x", random(), random());
  return hex.data();
}

Status CheckIsServer(const wire::Participant& participant) {
  const DdsIdentity* const identity = participant.identity();
  if (identity == nullptr || identity->holder == IdentityHolder::kServer) return {};
  return Fail(ErrorCode::kInvalidInput, "the identity of " + TextOf(*identity) + " is no server's",
              "Give rigcald the folder `server` that `rigcal identity init` made");
}

// Smaller goes first. An older rigcald tells no time: it was there before.
auto RankOf(const wire::ServerName& name) {
  return std::tuple(name.state != wire::ServerState::kServes, name.since.ns, name.id);
}

}  // namespace

std::optional<wire::ServerName> GoesBefore(const wire::ServerName& self, const std::vector<wire::ServerName>& others) {
  const wire::ServerName* first = nullptr;
  for (const wire::ServerName& other : others) {
    if (other.id == self.id || other.state == wire::ServerState::kWaits) continue;
    const bool is_before = self.state == wire::ServerState::kWaits || RankOf(other) < RankOf(self);
    if (is_before && (first == nullptr || RankOf(other) < RankOf(*first))) first = &other;
  }
  if (first == nullptr) return std::nullopt;
  return *first;
}

Error SecondServerError(const wire::ServerName& first) {
  return {ErrorCode::kConflict, "another server is on this DDS domain and tag: " + wire::TextOf(first),
          "Stop that one, keep this one apart by --tag or --domain, or let it wait with --standby"};
}

OnlyServer::OnlyServer(Presence presence, wire::ServerName self)
    : presence_(std::move(presence)), self_(std::move(self)), claimed_at_(std::chrono::steady_clock::now()) {}

Result<OnlyServer::Presence> OnlyServer::Presence::Open(const wire::ParticipantOptions& options) {
  RIGCAL_ASSIGN(auto participant, wire::Participant::Open(options));
  RIGCAL_TRY(CheckIsServer(participant));
  RIGCAL_ASSIGN(auto list, wire::ServerList::Open(participant));
  RIGCAL_ASSIGN(auto proof, wire::ProveServer(participant));
  return Presence{std::move(participant), std::move(list), std::move(proof)};
}

Result<OnlyServer> OnlyServer::Open(const wire::ParticipantOptions& options, const std::filesystem::path& data,
                                    bool waits, const std::string& store) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::absolute(data, error);
  wire::ServerName self;
  self.id = NewServerId();
  self.state = waits ? wire::ServerState::kWaits : wire::ServerState::kClaims;
  self.since = SystemClock().Now();
  if (wire::IdentityFolder(options.identity).empty()) {  // else it is read by those whom nobody let in
    self.host = HostName();
    self.pid = ::getpid();
    self.folder = (error ? data : folder).lexically_normal().string();
  }
  self.store = store;
  wire::ParticipantOptions told = options;
  told.user_data = wire::WriteServerName(self);
  RIGCAL_ASSIGN(auto presence, Presence::Open(told));
  return OnlyServer(std::move(presence), std::move(self));
}

Status OnlyServer::Reopen(const wire::ParticipantOptions& options) {
  RIGCAL_ASSIGN(auto next, Presence::Open(Named(options)));
  before_.emplace(std::move(presence_));
  before_until_ = std::chrono::steady_clock::now() + 2 * kShownWithin;
  presence_ = std::move(next);
  return {};
}

// Just after it was reopened it has not met all of them anew: who was there before is still there.
Result<std::optional<wire::ServerName>> OnlyServer::Before() {
  if (before_ && std::chrono::steady_clock::now() >= before_until_) before_.reset();
  RIGCAL_ASSIGN(const auto others, (before_ ? *before_ : presence_).list.Load());
  return GoesBefore(self_, others);
}

Status OnlyServer::Tell(wire::ServerState state) {
  self_.state = state;
  return presence_.participant.Tell(wire::WriteServerName(self_));
}

Status OnlyServer::Claim() {
  self_.since = SystemClock().Now();
  claimed_at_ = std::chrono::steady_clock::now();
  return Tell(wire::ServerState::kClaims);
}

Result<std::optional<wire::ServerName>> OnlyServer::TryToSettle() {
  std::this_thread::sleep_until(claimed_at_ +
                                (presence_.participant.identity() == nullptr ? kHeardWithin : kShownWithin));
  RIGCAL_ASSIGN(auto first, Before());
  RIGCAL_TRY(Tell(first ? wire::ServerState::kWaits : wire::ServerState::kServes));
  return first;
}

Status OnlyServer::Settle() {
  RIGCAL_ASSIGN(const auto first, TryToSettle());
  return first ? Status(Fail(SecondServerError(*first))) : Status();
}

wire::ParticipantOptions OnlyServer::Named(wire::ParticipantOptions options) const {
  options.user_data = wire::WriteServerName(self_);
  return options;
}

}  // namespace rigcal::dds
