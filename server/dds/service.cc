#include "server/dds/service.h"

#include <chrono>
#include <future>
#include <memory>
#include <random>
#include <thread>

#include "server/base/limits_in_force.h"
#include "server/dds/intake/intake.h"
#include "server/dds/record/recorder.h"
#include "server/dds/requests/requests.h"
#include "server/dds/tell/teller.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kInboxItemsMax = 200'000;
constexpr std::chrono::seconds kTurnWithin{
    30};  // each goes round once per second at least, unless the disk holds it up

constexpr int kAnsweringThreads = 4;
constexpr std::chrono::seconds kAnsweredWithin{90}, kToldWithin{90};

std::uint64_t NewIncarnation() {
  std::random_device random;
  return (std::uint64_t{random()} << 32) | random();
}

}  // namespace

struct Service::Impl {
  Impl(wire::Participant opened, Callbacks given) : participant(std::move(opened)), callbacks(std::move(given)) {}
  ~Impl() { Stop(); }
  void Stop();
  [[nodiscard]] Status Open(const Options& options);
  [[nodiscard]] Part& Expect(Vitals& vitals, const std::string& name, std::chrono::milliseconds within);
  void TellDecisions(const Clock& clock);
  void Start();

  // Threads are joined before any of it goes.
  wire::Participant participant;
  Callbacks callbacks;
  Inbox inbox{{limits::InForce().window_bytes, limits::InForce().intake_bytes, kInboxItemsMax}};
  Outbox outbox{participant, [this](const RobotId& robot) { teller->TellSoon(robot); }, callbacks.receipt_sent};
  LastQuestion asked;
  Vitals alone{SystemClock()};
  std::vector<Part*> parts;
  std::unique_ptr<Requests> requests;
  std::unique_ptr<Recorder> recorder;
  std::unique_ptr<Intake> intake;
  std::unique_ptr<Teller> teller;
  std::thread thread_d, thread_w, thread_t, thread_q;
};

Part& Service::Impl::Expect(Vitals& vitals, const std::string& name, std::chrono::milliseconds within) {
  return *parts.emplace_back(&vitals.Expect(name, within));
}

// A decision is told as soon as it is durable, before whoever made it has the answer.
void Service::Impl::TellDecisions(const Clock& clock) {
  callbacks.carry_out = [this, &clock, carry_out = callbacks.carry_out](
                            storage::Store& store, const std::string& verb, const std::string& json,
                            const OrderOrigin& origin) -> Result<OrderDone> {
    RIGCAL_ASSIGN(OrderDone done, carry_out(store, verb, json, origin));
    if (done.decided == 0) return done;
    teller->TellNext(done.robot);
    outbox.Send(Announcement{done.robot, "decision", std::to_string(done.decided), clock.Now(), done.document});
    return done;
  };
}

Status Service::Impl::Open(const Options& options) {
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(options.place));
  Vitals& vitals = options.vitals == nullptr ? alone : *options.vitals;
  std::vector<Answerers::Place> places;
  for (int i = 1; i <= kAnsweringThreads; ++i) {
    RIGCAL_ASSIGN(storage::Store own, storage::Store::Open(options.place));
    places.push_back({std::move(own), &Expect(vitals, "answers " + std::to_string(i), kAnsweredWithin)});
  }
  RIGCAL_ASSIGN(requests, Requests::Open(options.participant, callbacks, inbox, asked,
                                         Expect(vitals, "questions", kTurnWithin), std::move(places)));
  outbox.HoldAnnouncements(options.announces_after);
  const Clock& clock = options.clock == nullptr ? SystemClock() : *options.clock;
  if (callbacks.carry_out) TellDecisions(clock);
  RIGCAL_ASSIGN(storage::Store commit_store, storage::Store::Open(options.place));
  recorder = std::make_unique<Recorder>(
      Recorder::Stores{std::move(store), std::move(commit_store), options.intake},
      Recorder::Around{inbox, outbox, callbacks, clock, asked, Expect(vitals, "recorder", kTurnWithin)},
      NewIncarnation());
  RIGCAL_ASSIGN(storage::Store told_store, storage::Store::Open(options.place));
  teller =
      std::make_unique<Teller>(std::move(told_store), outbox, callbacks, Expect(vitals, "robot states", kToldWithin));
  RIGCAL_ASSIGN(Intake opened, Intake::Open(participant, outbox, inbox, Expect(vitals, "intake", kTurnWithin)));
  intake = std::make_unique<Intake>(std::move(opened));
  return {};
}

void Service::Impl::Start() {
  thread_w = std::thread([this] { recorder->Run(); });
  thread_t = std::thread([this] { teller->Run(); });
  thread_q = std::thread([this] { requests->Run(); });
  thread_d = std::thread([this] { intake->Run(); });
}

void Service::Impl::Stop() {
  if (intake) intake->Stop();
  inbox.Stop();
  if (requests) requests->Stop();
  if (teller) teller->Stop();
  for (std::thread* thread : {&thread_d, &thread_w, &thread_t, &thread_q})
    if (thread->joinable()) thread->join();
  requests.reset();                       // with the threads that answer
  for (Part* part : parts) part->Rest();  // nobody waits for them
}

Service::Service(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Service::~Service() = default;
Service::Service(Service&&) noexcept = default;
Service& Service::operator=(Service&&) noexcept = default;

Result<Service> Service::Start(const Options& options, Callbacks callbacks) {
  RIGCAL_ASSIGN(wire::Participant participant, wire::Participant::Open(options.participant));
  auto impl = std::make_unique<Impl>(std::move(participant), std::move(callbacks));
  RIGCAL_TRY(impl->Open(options));
  impl->Start();
  return Service(std::move(impl));
}

std::deque<Announcement> Service::Close() {
  impl_->Stop();
  return impl_->outbox.TakeHeld();
}

void Service::Announce(const Announcement& announcement) { impl_->outbox.Send(announcement); }

Result<std::string> Service::GiveOrder(const std::string& verb, const std::string& json) {
  constexpr std::chrono::seconds kAnsweredOrderWithin{10};
  const auto document = std::make_shared<std::promise<Result<std::string>>>();
  auto future = document->get_future();
  const auto answer = [document](Result<std::string> done) { document->set_value(std::move(done)); };
  if (!impl_->inbox.Offer(Order{verb, json, answer, "", {OrderChannel::kHttp}}))
    return Fail(ErrorCode::kBusy, "the server has more to take in than it can hold", "Try again in a moment.");
  if (future.wait_for(kAnsweredOrderWithin) == std::future_status::ready) return future.get();
  return Fail(ErrorCode::kBusy, "the server has not come to '" + verb + "' yet",
              "Look whether it was done before you ask again.");
}

Status Service::TakeIn(Arrival arrival) {
  constexpr std::chrono::milliseconds kRoomWithin{10'000};
  if (impl_->inbox.OfferWithin(std::move(arrival), kRoomWithin)) return {};
  return Fail(ErrorCode::kBusy, "the server has more to take in than it can hold", "Send it again in a moment.");
}

std::vector<metrics::Reading> Service::Readings() const {
  const Inbox::Load load = impl_->inbox.Look();
  const auto number = [](auto count) { return static_cast<double>(count); };
  return {{"rigcal_intake_waiting_bytes", "Bytes that robots sent and that are not on disk yet", number(load.bytes)},
          {"rigcal_intake_limit_bytes", "As many bytes may wait: the limit intake_bytes", number(load.bytes_max)},
          {"rigcal_intake_arrivals_waiting", "Messages that robots sent and that nobody has taken up yet",
           number(load.arrivals)},
          {"rigcal_sessions_open", "Sessions that are being received", number(impl_->recorder->OpenSessions())},
          {"rigcal_sessions_open_limit", "As many may be received at once: the limit open_sessions",
           number(limits::InForce().open_sessions)},
          {"rigcal_questions_waiting", "Questions over DDS that no thread has taken up yet",
           number(impl_->requests->Waiting())}};
}

void Service::Tell(const RobotId& robot) { impl_->teller->TellNext(robot); }

}  // namespace rigcal::dds
