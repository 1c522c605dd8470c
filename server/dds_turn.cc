#include "server/dds_turn.h"

#include "server/base/log.h"
#include "server/base/process/thread_rank.h"

namespace rigcal {
namespace {

constexpr std::chrono::seconds kTryAgain{2};

}  // namespace

DdsTurn::DdsTurn(dds::OnlyServer& only, ServiceRelay& relay, Start start)
    : only_(only), relay_(relay), start_(std::move(start)) {}

Status DdsTurn::Speak() {
  SetThreadRank(ThreadRank::kTakes);  // DDS makes threads of its own
  auto service = start_();
  SetThreadRank(ThreadRank::kServes);
  if (!service) return Fail(service.error());
  service_.emplace(*std::move(service));
  open_.emplace(relay_, *service_);
  return {};
}

Status DdsTurn::Look() {
  const auto first = only_.Before();
  if (!first) LogWarn(Sentence(first.error()));
  if (!first) return {};
  if (*first && service_) return GiveWay(**first);
  if (!*first && !service_ && std::chrono::steady_clock::now() >= next_try_) TryToSpeak();
  return {};
}

Status DdsTurn::GiveWay(const wire::ServerName& first) {
  if (!only_.SharesStoreWith(first)) return Fail(dds::SecondServerError(first));
  LogWarn(wire::TextOf(first) + " of the same store speaks DDS here, too, and did so before: this one stands ready");
  open_.reset();
  service_.reset();
  return only_.GiveWay();
}

// Where it cannot, say because the database is away, another server may, or this one later.
void DdsTurn::TryToSpeak() {
  const auto first = TakePlace(only_);
  if (first && *first) return;
  const Status spoken = first ? Speak() : Fail(first.error());
  if (spoken) return LogInfo("no other server speaks DDS here: this one does from now on");
  LogError(spoken.error());
  next_try_ = std::chrono::steady_clock::now() + kTryAgain;
  if (const Status gave = only_.GiveWay(); !gave) LogError(gave.error());
}

Result<std::optional<wire::ServerName>> SettleBeside(dds::OnlyServer& only) {
  RIGCAL_ASSIGN(auto first, only.TryToSettle());
  if (first && !only.SharesStoreWith(*first)) return Fail(dds::SecondServerError(*first));
  return first;
}

Result<std::optional<wire::ServerName>> TakePlace(dds::OnlyServer& only) {
  RIGCAL_TRY(only.Claim());
  return only.TryToSettle();
}

}  // namespace rigcal
