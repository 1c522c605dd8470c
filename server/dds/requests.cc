#include "server/dds/requests.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/base/log.h"
#include "server/base/thread_rank.h"
#include "server/formats/answers.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kQuestionsMax = 1'024;
constexpr std::size_t kPendingMax = 256;
constexpr std::chrono::seconds kPendingFor{5};
constexpr std::chrono::milliseconds kBusyAgain{20};
constexpr std::chrono::seconds kIdle{1};

std::vector<std::string> Split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < text.size() || parts.empty(); at += limits::kReplyPartBytes)
    parts.push_back(text.substr(at, limits::kReplyPartBytes));
  return parts;
}

}  // namespace

void Requests::Offer(Question question) {
  const std::lock_guard lock(mutex_);
  if (questions_.size() >= kQuestionsMax)
    return LogWarn("too many requests at once: one from " + question.partition + " is dropped");
  questions_.push_back(std::move(question));
  changed_.notify_one();
}

void Requests::ReadersChanged() {
  const std::lock_guard lock(mutex_);
  readers_changed_ = true;
  changed_.notify_one();
}

void Requests::Stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  changed_.notify_one();
}

std::string Requests::DocumentOf(const Question& question) const {
  if (question.json.size() > limits::kRequestBytesMax)
    return formats::WriteError({ErrorCode::kInvalidInput,
                                "a request of " + std::to_string(question.json.size()) + " bytes",
                                "Ask with at most " + std::to_string(limits::kRequestBytesMax) + " bytes"});
  Result<std::string> answer = answer_(question.verb, question.json);
  return answer ? std::move(*answer) : formats::WriteError(answer.error());
}

bool Requests::Send(Pending& pending) const {
  pending.busy = false;
  while (pending.next_idx < pending.parts.size()) {
    rigcal_wire_Reply part{};
    if (!wire::CopyText(pending.question.id, part.id, sizeof part.id, "request id")) return true;
    part.part_idx = static_cast<std::uint32_t>(pending.next_idx);
    part.part_count = static_cast<std::uint32_t>(pending.parts.size());
    part.json = pending.parts[pending.next_idx].data();
    const Status sent = outbox_.Reply(pending.question.partition, pending.question.participant, part);
    if (sent) {
      ++pending.next_idx;
      continue;
    }
    pending.busy = sent.error().code == ErrorCode::kBusy;
    if (!pending.busy && sent.error().code != ErrorCode::kUnreachable) LogError(sent.error());
    return !pending.busy && sent.error().code != ErrorCode::kUnreachable;
  }
  return true;
}

void Requests::Add(Question question) {
  Pending pending;
  pending.parts = Split(DocumentOf(question));
  pending.question = std::move(question);
  pending.expires = std::chrono::steady_clock::now() + kPendingFor;
  if (Send(pending)) return;
  if (pending_.size() >= kPendingMax) pending_.pop_front();
  pending_.push_back(std::move(pending));
}

void Requests::SendPending() {
  const Time now = std::chrono::steady_clock::now();
  pending_.remove_if([&](Pending& pending) { return Send(pending) || pending.expires <= now; });
}

// The next question; nothing if it is time to look after the replies that wait.
std::optional<Question> Requests::Next() {
  const bool any_busy = std::any_of(pending_.begin(), pending_.end(), [](const Pending& one) { return one.busy; });
  std::unique_lock lock(mutex_);
  const std::chrono::milliseconds patience = any_busy ? kBusyAgain : std::chrono::milliseconds(kIdle);
  changed_.wait_for(lock, patience, [&] { return stopped_ || readers_changed_ || !questions_.empty(); });
  readers_changed_ = false;
  if (questions_.empty() || stopped_) return std::nullopt;
  Question question = std::move(questions_.front());
  questions_.pop_front();
  return question;
}

void Requests::Run() {
  SetThreadRank(ThreadRank::kAnswers);
  const auto stopped = [&] {
    const std::lock_guard lock(mutex_);
    return stopped_;
  };
  while (!stopped()) {
    if (auto question = Next()) Add(std::move(*question));
    if (!pending_.empty()) SendPending();
  }
}

}  // namespace rigcal::dds
