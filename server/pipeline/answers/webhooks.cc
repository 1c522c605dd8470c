#include "server/pipeline/answers/webhooks.h"

#include <map>

#include "server/formats/alerts/webhook_answers.h"
#include "storage/alerts/outbox.h"

namespace rigcal::pipeline {
namespace {

Result<std::vector<ReceiverState>> LoadStates(storage::Store& store) {
  std::vector<ReceiverState> states;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(states, storage::LoadReceivers(store));
    return {};
  }));
  return states;
}

// Addresses that differ in what is not shown are one, as no two samples may have one name.
void AddPerReceiver(const std::string& name, const std::string& help, const std::vector<ReceiverState>& states,
                    std::int64_t ReceiverState::*count, std::vector<metrics::Reading>& readings) {
  std::map<std::string, std::int64_t> by_url;
  for (const ReceiverState& one : states) by_url[one.url] += one.*count;
  for (const auto& [url, sum] : by_url) readings.push_back({name, help, static_cast<double>(sum), {{"url", url}}});
}

}  // namespace

Result<std::string> ListWebhooks(const AnswerContext& context, const formats::Parameters&) {
  RIGCAL_ASSIGN(const auto states, LoadStates(context.store));
  return formats::WriteWebhooks(states, context.clock.Now());
}

Result<std::vector<metrics::Reading>> AlertReadings(storage::Store& store, const FleetCounts& fleet) {
  RIGCAL_ASSIGN(const auto states, LoadStates(store));
  std::vector<metrics::Reading> readings;
  for (const auto& [word, robots] : fleet.statuses)
    readings.push_back(
        {"rigcal_robots_by_status", "Robots by status", static_cast<double>(robots), {{"status", NameOf(word)}}});
  AddPerReceiver("rigcal_webhook_waiting", "Alerts that wait for this receiver", states, &ReceiverState::waiting,
                 readings);
  AddPerReceiver("rigcal_webhook_delivered_total", "Alerts that this receiver took", states, &ReceiverState::delivered,
                 readings);
  return readings;
}

}  // namespace rigcal::pipeline
