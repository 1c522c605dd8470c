#include "server/pipeline/answers/webhooks.h"

#include <map>

#include "server/formats/alerts/webhook_answers.h"
#include "storage/alerts/outbox.h"

namespace rigcal::pipeline {
namespace {

// In a label of Prometheus' text a backslash and a quotation mark are escaped; an address has no line end.
std::string LabelOf(const std::string& url) {
  std::string label;
  for (const char c : url) {
    if (c == '\\' || c == '"') label += '\\';
    label += c;
  }
  return label;
}

Result<std::vector<ReceiverState>> LoadStates(storage::Store& store) {
  std::vector<ReceiverState> states;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(states, storage::LoadReceivers(store));
    return {};
  }));
  return states;
}

// Addresses that differ in what is not shown are one, as no two samples may have one name.
std::string MetricOf(const std::string& name, const std::vector<ReceiverState>& states, std::int64_t ReceiverState::*count) {
  std::map<std::string, std::int64_t> by_url;
  for (const ReceiverState& one : states) by_url[one.url] += one.*count;
  std::string text;
  for (const auto& [url, sum] : by_url) text += name + "{url=\"" + LabelOf(url) + "\"} " + std::to_string(sum) + "\n";
  return text;
}

}  // namespace

Result<std::string> ListWebhooks(const AnswerContext& context, const formats::Parameters&) {
  RIGCAL_ASSIGN(const auto states, LoadStates(context.store));
  return formats::WriteWebhooks(states, context.clock.Now());
}

Result<std::string> AlertMetrics(storage::Store& store, const FleetCounts& fleet) {
  RIGCAL_ASSIGN(const auto states, LoadStates(store));
  std::string text;
  for (const auto& [word, robots] : fleet.statuses)
    text += "rigcal_robots_by_status{status=\"" + NameOf(word) + "\"} " + std::to_string(robots) + "\n";
  return text + MetricOf("rigcal_webhook_waiting", states, &ReceiverState::waiting) +
         MetricOf("rigcal_webhook_delivered_total", states, &ReceiverState::delivered);
}

}  // namespace rigcal::pipeline
