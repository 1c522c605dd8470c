#include "client/wire/transfer.h"

#include <algorithm>
#include <chrono>

#include "client/text/progress.h"
#include "client/wire/connection.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kSaySilent_ns = 3'000'000'000;
constexpr milliseconds kTick(200);  // a bar moves at least this often

milliseconds WaitFor(std::int64_t until_ns, std::int64_t now_ns) {
  const auto wait =
      std::chrono::ceil<milliseconds>(std::chrono::nanoseconds(std::max<std::int64_t>(until_ns - now_ns, 0)));
  return std::min(wait, kTick);
}

// One transfer while it runs.
class Transfer {
 public:
  Transfer(wire::Reader<rigcal_wire_Receipt> receipts, wire::WaitSet waitset, OneServer one_server,
           const TransferPlace& place, PushEngine& engine, Outlet& outlet, const TransferHooks& hooks)
      : receipts_(std::move(receipts)),
        waitset_(std::move(waitset)),
        one_server_(std::move(one_server)),
        place_(place),
        engine_(engine),
        outlet_(outlet),
        hooks_(hooks) {}

  Status Run() {
    RIGCAL_TRY(waitset_.Attach(receipts_.get()));
    for (const dds_entity_t writer : outlet_.Writers()) RIGCAL_TRY(waitset_.Attach(writer));
    while (true) {
      RIGCAL_TRY(TakeReceipts());
      RIGCAL_TRY(one_server_.CheckOften());
      const std::int64_t now_ns = SteadyNow_ns();
      const PushAction action = engine_.Next(now_ns);
      if (action.kind == PushAction::Kind::kClosed) return one_server_.Check();
      if (action.kind == PushAction::Kind::kRefused) return Fail(*engine_.talk().error);
      if (action.kind == PushAction::Kind::kGaveUp) return GiveUp(now_ns);
      RIGCAL_TRY(Do(action, now_ns));
      SayWhetherServerIsThere(now_ns);
      if (hooks_.on_tick && engine_.talk().answered) hooks_.on_tick(engine_, now_ns);
    }
  }

 private:
  Status TakeReceipts() {
    Status bad;
    RIGCAL_TRY(receipts_.Take(64, [&](const rigcal_wire_Receipt& sample, const wire::SampleOrigin&) {
      if (place_.subject_id != sample.subject_id) return;
      const auto receipt = wire::FromReceipt(sample);
      if (receipt)
        engine_.OnReceipt(*receipt, SteadyNow_ns());
      else
        bad = Fail(receipt.error());
    }));
    RIGCAL_TRY(bad);
    const std::string complaint = engine_.talk().complaint ? engine_.talk().complaint->what : "";
    const bool is_new = !complaint.empty() && complaint != told_.complaint;
    told_.complaint = complaint;
    return is_new ? outlet_.CheckInput() : Status();
  }

  // A question that nobody can hear is not asked: it waits for a match instead.
  Status Do(const PushAction& action, std::int64_t now_ns) {
    switch (action.kind) {
      case PushAction::Kind::kSendHeader:
        if (outlet_.HasServer()) return AskServer();
        engine_.NotAsked();
        return waitset_.Wait(kTick).map([](bool) {});
      case PushAction::Kind::kSendManifest:
        return SayIfBusy(outlet_.SendManifest());
      case PushAction::Kind::kSendChunk: {
        const Status sent = outlet_.SendChunk(action.chunk);
        if (!sent && sent.error().code == ErrorCode::kBusy) engine_.NotSent(action.chunk);
        return SayIfBusy(sent);
      }
      default:
        return waitset_.Wait(WaitFor(action.until_ns, now_ns)).map([](bool) {});
    }
  }

  // What two servers would both take is not sent.
  Status AskServer() {
    RIGCAL_TRY(one_server_.Check());
    return SayIfBusy(outlet_.SendHeader(engine_));
  }

  // The engine asks again by itself what DDS did not take.
  static Status SayIfBusy(const Status& sent) {
    if (!sent && sent.error().code == ErrorCode::kBusy) return {};
    return sent;
  }

  void SayWhetherServerIsThere(std::int64_t now_ns) {
    const bool is_silent = engine_.SilentFor(now_ns) > kSaySilent_ns;
    if (is_silent == told_.is_silent || !hooks_.say) return;
    told_.is_silent = is_silent;
    hooks_.say(is_silent ? "No rigcald answers on " + place_.where + ". Still trying; nothing is lost."
                         : "rigcald answers.");
  }

  Status GiveUp(std::int64_t now_ns) const {
    const milliseconds waited(engine_.SilentFor(now_ns) / 1'000'000);
    Error error = UnreachableError(place_.where, waited);
    if (engine_.talk().answered)
      error.cure = "Start it again, then repeat the command: what it has on disk is not sent again";
    return Fail(std::move(error));
  }

  wire::Reader<rigcal_wire_Receipt> receipts_;
  wire::WaitSet waitset_;
  OneServer one_server_;
  const TransferPlace& place_;
  PushEngine& engine_;
  Outlet& outlet_;
  const TransferHooks& hooks_;
  struct {
    std::string complaint;
    bool is_silent = false;
  } told_;  // what was said of the server last
};

}  // namespace

std::int64_t SteadyNow_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Status RunTransfer(const wire::Participant& participant, const TransferPlace& place, PushEngine& engine, Outlet& outlet,
                   const TransferHooks& hooks) {
  RIGCAL_ASSIGN(auto receipts,
                wire::Reader<rigcal_wire_Receipt>::Open(participant, {wire::RobotPartition(place.robot)}));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_ASSIGN(auto one_server, OneServer::Open(participant, place.where));
  return Transfer(std::move(receipts), std::move(waitset), std::move(one_server), place, engine, outlet, hooks).Run();
}

}  // namespace rigcal::client
