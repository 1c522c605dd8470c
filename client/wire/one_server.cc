#include "client/wire/one_server.h"

#include <algorithm>

#include "client/text/table.h"

namespace rigcal::client {
namespace {

// A second after a participant came, all that answer it are alive; and a lease is over after three.
constexpr std::chrono::seconds kNewcomerFor{1};
constexpr std::chrono::seconds kBothStay{5};
constexpr std::chrono::milliseconds kLookEvery{50};

std::string PlaceOf(const wire::ServerName& name) {
  return name.host.empty() ? name.id : name.host + '\n' + name.folder;
}

}  // namespace

Status ServersSeen::Judge(const std::vector<wire::ServerName>& listed, Time now) {
  std::map<std::string, Seen> seen;
  for (const wire::ServerName& name : listed) {
    if (name.state != wire::ServerState::kServes) continue;
    const auto before = seen_.find(PlaceOf(name));
    seen.emplace(PlaceOf(name), Seen{name, before == seen_.end() ? now : before->second.since});
  }
  seen_ = std::move(seen);
  std::vector<const Seen*> believed;
  for (const auto& [place, one] : seen_)
    if (one.since - opened_at_ <= kNewcomerFor || now - one.since >= kBothStay) believed.push_back(&one);
  if (believed.size() < 2) return {};
  return Fail(ErrorCode::kUnreachable,
              "two servers are on " + where_ + ": " + Plain(wire::TextOf(believed[0]->name)) + ", and " +
                  Plain(wire::TextOf(believed[1]->name)),
              "Stop one of them, or keep them apart by --tag or --domain; then repeat the command");
}

Result<OneServer> OneServer::Open(const wire::Participant& participant, const std::string& where) {
  RIGCAL_ASSIGN(auto list, wire::ServerList::Open(participant));
  return OneServer(std::move(list), ServersSeen(where, std::chrono::steady_clock::now()));
}

Status OneServer::Check() {
  checked_at_ = std::chrono::steady_clock::now();
  RIGCAL_ASSIGN(const auto listed, list_.Load());
  return seen_.Judge(listed, checked_at_);
}

Status OneServer::CheckOften() {
  if (std::chrono::steady_clock::now() - checked_at_ < kLookEvery) return {};
  return Check();
}

}  // namespace rigcal::client
