#include "server/formats/sessions/refusals.h"

namespace rigcal::formats {

Status KeepGood(const std::vector<Status>& outcomes, const Refusals& refusals, std::vector<Payload>& payloads) {
  std::vector<Payload> good;
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    if (outcomes[i])
      good.push_back(std::move(payloads[i]));
    else
      RIGCAL_TRY(refusals.Take(outcomes[i].error()));
  }
  payloads = std::move(good);
  return {};
}

}  // namespace rigcal::formats
