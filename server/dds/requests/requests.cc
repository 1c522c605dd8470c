#include "server/dds/requests/requests.h"

#include <algorithm>
#include <future>

#include "idl/security.h"
#include "server/base/limits.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"
#include "server/dds/intake/arrival.h"
#include "server/formats/answers/answers.h"
#include "server/metrics/noted.h"

namespace rigcal::dds {
namespace {

constexpr int kTakenAtOnce = 16;  // the others stay with DDS, which bounds them
constexpr std::size_t kPendingMax = 256;
constexpr std::chrono::seconds kPendingFor{5};  // once it is known
constexpr std::chrono::seconds kAnswerFor{60};  // a slow question; an order, while the disk is busy
constexpr std::chrono::milliseconds kBusyAgain{20};
constexpr std::chrono::milliseconds kRequestIdle{1000};

std::vector<std::string> Split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < text.size() || parts.empty(); at += limits::kReplyPartBytes)
    parts.push_back(text.substr(at, limits::kReplyPartBytes));
  return parts;
}

// DDS makes threads of its own, of the rank of the thread that opens.
Result<wire::Participant> OpenApart(wire::ParticipantOptions options) {
  options.apart = true;
  const auto open = [&] {
    SetThreadRank(ThreadRank::kAnswers);
    return wire::Participant::Open(options);
  };
  return std::async(std::launch::async, open).get();
}

std::string DocumentOfAnswer(Result<std::string> answer) {
  if (!answer) metrics::NoteAnswerFailure(metrics::Channel::kDds, answer.error().code);
  return answer ? std::move(*answer) : formats::WriteError(answer.error());
}

std::shared_future<std::string> Said(const Error& error) {
  std::promise<std::string> said;
  said.set_value(DocumentOfAnswer(Fail(error)));
  return said.get_future().share();
}

// What is said in "operator/..." counts with identities alone: else whoever has another partition as well writes there.
bool IsOfPeople(const std::string& partition, bool is_secured) {
  return is_secured ? wire::OperatorOfPartition(partition).has_value() : partition == wire::kOperatorPartition;
}

// The first partition of a writer in which questions may be asked; nothing if there is none.
std::optional<std::string> AskedIn(const wire::SampleOrigin& origin, bool is_secured) {
  for (const std::string& partition : origin.partitions)
    if (IsOfPeople(partition, is_secured) || RobotOfPartition(partition)) return partition;
  return std::nullopt;
}

OrderOrigin OriginOf(const Question& question, bool is_secured) {
  OrderOrigin origin;
  const auto who = is_secured ? wire::OperatorOfPartition(question.partition) : std::nullopt;
  if (who) origin.verified = VerifiedPerson{who->name, who->role};
  return origin;
}

// It was sent whole.
void NoteAnswered(const Question& question, bool is_order, std::chrono::steady_clock::time_point asked_at) {
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - asked_at).count();
  metrics::NoteAnswer(metrics::Channel::kDds, took_s);
  const std::string robot = RobotOfPartition(question.partition) ? RobotOfPartition(question.partition)->str() : "";
  Log(is_order ? LogLevel::kInfo : LogLevel::kDebug,
      {.event = is_order ? "order" : "answer", .robot = robot, .request = question.id},
      "'" + question.verb + "' answered after " + std::to_string(took_s) + " s");
}

std::optional<Error> Refused(const Question& question, bool is_order, bool is_secured) {
  if (question.json.size() > limits::kRequestBytesMax)
    return Error{ErrorCode::kInvalidInput, "a request of " + std::to_string(question.json.size()) + " bytes",
                 "Ask with at most " + std::to_string(limits::kRequestBytesMax) + " bytes"};
  if (is_order && !IsOfPeople(question.partition, is_secured))
    return Error{ErrorCode::kInvalidInput, "'" + question.verb + "' was asked by a robot",
                 "Ask in the partition of people: '" + std::string(wire::kOperatorPartition) + "'."};
  return std::nullopt;
}

// A client that asks again takes the answer to any copy: the older one, of which nothing was sent yet, goes. Beyond so
// many the oldest of the same client goes, and orders never.
void MakeRoomFor(const PendingReply& added, std::list<PendingReply>& waiting) {
  const auto same_client = [&](const PendingReply& one) {
    return !one.is_order && one.question.participant == added.question.participant;
  };
  waiting.remove_if([&](const PendingReply& one) {
    return same_client(one) && one.next_idx == 0 && one.question.partition == added.question.partition &&
           one.question.verb == added.question.verb && one.question.json == added.question.json;
  });
  if (waiting.size() < kPendingMax) return;
  auto oldest = std::find_if(waiting.begin(), waiting.end(), same_client);
  if (oldest == waiting.end())
    oldest = std::find_if(waiting.begin(), waiting.end(), [](const PendingReply& one) { return !one.is_order; });
  if (oldest != waiting.end()) waiting.erase(oldest);
}

Result<std::vector<Question>> TakeQuestions(wire::Reader<rigcal_wire_Request>& reader, bool is_secured) {
  std::vector<Question> questions;
  RIGCAL_TRY(reader.Take(kTakenAtOnce, [&](const auto& sample, const wire::SampleOrigin& origin) {
    const auto partition = AskedIn(origin, is_secured);
    if (!partition) return;
    const char* json = sample.json == nullptr ? "" : sample.json;
    questions.push_back({*partition, origin.participant, sample.id, sample.verb, json});
  }));
  return questions;
}

std::chrono::milliseconds PatienceWith(const std::list<PendingReply>& waiting) {
  const bool any_busy = std::any_of(waiting.begin(), waiting.end(), [](const PendingReply& one) { return one.busy; });
  return any_busy ? kBusyAgain : kRequestIdle;
}

}  // namespace

Requests::Requests(wire::Participant participant, wire::Reader<rigcal_wire_Request> reader, wire::WaitSet waitset,
                   const Callbacks& callbacks, Inbox& inbox, LastQuestion& asked, Part& part)
    : ends_{std::move(participant), std::move(reader), std::move(waitset)},
      callbacks_(callbacks),
      inbox_(inbox),
      asked_(asked),
      part_(part) {}

Result<std::unique_ptr<Requests>> Requests::Open(const wire::ParticipantOptions& options, const Callbacks& callbacks,
                                                 Inbox& inbox, LastQuestion& asked, Part& part,
                                                 std::vector<Answerers::Place> places) {
  RIGCAL_ASSIGN(auto participant, OpenApart(options));
  const bool is_secured = participant.identity() != nullptr;
  const char* const people = is_secured ? wire::kAllOperatorsPartition : wire::kOperatorPartition;
  RIGCAL_ASSIGN(auto reader, wire::Reader<rigcal_wire_Request>::Open(participant, {people, wire::kAllRobotsPartition}));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(reader.get()));
  std::unique_ptr<Requests> made(
      new Requests(std::move(participant), std::move(reader), std::move(waitset), callbacks, inbox, asked, part));
  if (!is_secured) RIGCAL_TRY(made->ends_.writers.Add(wire::kOperatorPartition));
  const auto work = [&callbacks](storage::Store& store, const std::string& verb,
                                 const std::string& json) -> std::string {
    auto answer = Guarded([&] { return callbacks.answer(store, verb, json); });
    if (answer) return std::move(*answer);
    return OnceThereIsMemory([&] { return DocumentOfAnswer(Fail(answer.error())); });
  };
  made->answerers_ =
      std::make_unique<Answerers>(std::move(places), work, [raw = made.get()] { raw->ends_.waitset.Wake(); });
  return made;
}

void Requests::Stop() {
  retry_.Stop();
  ends_.waitset.Wake();
}

// Thread W answers from its own thread; this one is woken to send it.
std::shared_future<std::string> Requests::GiveOrder(const Question& question) {
  auto document = std::make_shared<std::promise<std::string>>();
  std::shared_future<std::string> future = document->get_future().share();
  const auto answer = [this, document](Result<std::string> done) {
    answerers_->Changed();  // before anybody knows
    document->set_value(DocumentOfAnswer(std::move(done)));
    ends_.waitset.Wake();
  };
  if (!inbox_.Offer(Order{question.verb, question.json, answer, question.id, OriginOf(question, ends_.IsSecured())}))
    document->set_value(DocumentOfAnswer(
        Fail(ErrorCode::kBusy, "the server has more to take in than it can hold", "Try again in a moment.")));
  return future;
}

bool Requests::Send(PendingReply& pending) {
  pending.busy = false;
  if (pending.parts.empty()) {
    if (pending.answer.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    const auto document = Guarded([&]() -> Result<std::string> { return pending.answer.get(); });
    pending.parts = Split(document ? *document : DocumentOfAnswer(Fail(document.error())));
    pending.expires = std::chrono::steady_clock::now() + kPendingFor;
    asked_.Note();  // an answer may take longer than what is kept clear after a question
  }
  while (pending.next_idx < pending.parts.size()) {
    rigcal_wire_Reply part{};
    if (!wire::CopyText(pending.question.id, part.id, sizeof part.id, "request id")) return true;
    part.part_idx = static_cast<std::uint32_t>(pending.next_idx);
    part.part_count = static_cast<std::uint32_t>(pending.parts.size());
    part.json = pending.parts[pending.next_idx].data();
    const Status sent = ends_.writers.Send(pending.question.partition, pending.question.participant, part);
    if (sent) {
      ++pending.next_idx;
      continue;
    }
    pending.busy = sent.error().code == ErrorCode::kBusy;
    if (!pending.busy && sent.error().code != ErrorCode::kUnreachable) LogError(sent.error());
    return !pending.busy && sent.error().code != ErrorCode::kUnreachable;
  }
  NoteAnswered(pending.question, pending.is_order, pending.asked_at);
  return true;
}

std::shared_future<std::string> Requests::AnswerTo(const Question& question) {
  const bool is_order = callbacks_.is_order(question.verb);
  if (const auto refused = Refused(question, is_order, ends_.IsSecured())) return Said(*refused);
  if (is_order) return GiveOrder(question);
  if (auto answer = answerers_->Ask(question.participant, question.verb, question.json)) return *answer;
  return Said({ErrorCode::kBusy, "more questions wait for an answer than the server takes", "Ask again in a moment."});
}

void Requests::Add(Question question) {
  std::list<PendingReply> added(1);
  PendingReply& pending = added.front();
  auto answer = Guarded([&]() -> Result<std::shared_future<std::string>> { return AnswerTo(question); });
  pending.answer = answer ? std::move(*answer) : Said(answer.error());
  pending.question = std::move(question);
  pending.expires = std::chrono::steady_clock::now() + kAnswerFor;
  pending.is_order = callbacks_.is_order(pending.question.verb);
  if (SendOrWait(pending)) return;
  MakeRoomFor(pending, pending_);
  pending_.splice(pending_.end(), added);
}

// For want of memory it is tried again, soon.
bool Requests::SendOrWait(PendingReply& pending) {
  const auto sent = Guarded([&]() -> Result<bool> { return Send(pending); });
  if (!sent) LogError(sent.error());
  pending.busy = pending.busy || !sent;
  return sent && *sent;
}

void Requests::SendPending() {
  const Time now = std::chrono::steady_clock::now();
  pending_.remove_if([&](PendingReply& pending) { return SendOrWait(pending) || pending.expires <= now; });
}

// What was asked is answered also where waiting for it failed.
Status Requests::Round() {
  const auto woken = ends_.waitset.Wait(PatienceWith(pending_));
  RIGCAL_ASSIGN(auto questions, TakeQuestions(ends_.reader, ends_.IsSecured()));
  for (Question& question : questions) {
    if (retry_.Stopped()) return {};
    asked_.Note();
    Add(std::move(question));
    if (!pending_.empty()) SendPending();
  }
  if (!pending_.empty()) SendPending();
  ends_.writers.CloseQuiet();
  return woken ? Status() : Fail(woken.error());
}

void Requests::Run() {
  SetThreadRank(ThreadRank::kAnswers);
  while (!retry_.Stopped()) {
    Status done = Guarded([this] { return Round(); });
    if (done) {
      part_.Turn();
      continue;
    }
    part_.Fail(std::move(done).error());
    retry_.Pause();
  }
}

}  // namespace rigcal::dds
