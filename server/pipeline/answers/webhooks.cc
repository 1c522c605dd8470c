#include "server/pipeline/answers/webhooks.h"

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
  for (const ReceiverState& one : states) {
    const std::string label = "{url=\"" + LabelOf(one.url) + "\"} ";
    text += "rigcal_webhook_waiting" + label + std::to_string(one.waiting) + "\nrigcal_webhook_delivered_total" + label +
            std::to_string(one.delivered) + "\n";
  }
  return text;
}

}  // namespace rigcal::pipeline
