#include "server/dds_turn.h"

#include "server/base/log.h"
#include "server/base/process/thread_rank.h"

namespace rigcal {
namespace {

constexpr std::chrono::seconds kTryAgain{2};
constexpr std::chrono::seconds kMetAgain{5};  // as long as identities take to shake hands, and some more

}  // namespace

DdsTurn::DdsTurn(dds::OnlyServer& only, ServiceRelay& relay, wire::ParticipantOptions participant, Start start)
    : only_(only), relay_(relay), participant_(std::move(participant)), start_(std::move(start)) {}

// DDS reads the files of the identity anew, also those that Look refused.
Status DdsTurn::Speak() {
  RIGCAL_TRY(identity_.CheckMayBeRead());
  SetThreadRank(ThreadRank::kTakes);  // DDS makes threads of its own
  auto service = start_(opens_anew_ ? kMetAgain : std::chrono::seconds(0));
  SetThreadRank(ThreadRank::kServes);
  if (!service) return Fail(service.error());
  opens_anew_ = false;
  service_.emplace(*std::move(service));
  open_.emplace(relay_, *service_);
  return {};
}

// DDS looks at who is revoked when it first meets somebody, so all are met anew.
Status DdsTurn::TakeUpIdentity() {
  SetThreadRank(ThreadRank::kTakes);
  Status done = only_.Reopen(participant_);
  SetThreadRank(ThreadRank::kServes);
  if (!done) {
    identity_.WasRefused();
    return done;
  }
  identity_.TakenUp();  // whatever speaks from here on reads the files anew
  if (service_) {
    opens_anew_ = true;
    relay_.AnotherFollows(true);
    open_.reset();
    relay_.KeepFirst(service_->Close());
    service_.reset();
    RIGCAL_TRY(Speak());
  }
  LogInfo("the files of the server's identity changed: all are met anew over DDS, and who is revoked is not");
  return {};
}

Status DdsTurn::Look() {
  if (identity_.HasNext()) {
    const Status done = TakeUpIdentity();
    if (!done)
      LogError({done.error().code, "the changed identity of the server cannot be taken up yet: " + done.error().what,
                done.error().cure + " It is tried again soon; until then who was revoked since may be let in."});
  }
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
  if (first && *first) {
    opens_anew_ = false;
    return relay_.AnotherFollows(false);  // who speaks tells
  }
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
