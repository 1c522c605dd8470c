// Prints every receipt that a server sends, one JSON object a line, until standard input closes: an observer that is
// not the client, for tests that kill client and server.
#include <poll.h>

#include <cstdio>
#include <string>

#include "idl/convert.h"
#include "idl/dds.h"

namespace {

void Print(const rigcal_wire_Receipt& sample) {
  const auto receipt = rigcal::wire::FromReceipt(sample);
  if (!receipt) return;
  std::string held;
  for (std::size_t i = 0; i < receipt->held.size(); ++i)
    if (receipt->held[i]) held += (held.empty() ? "" : ",") + std::to_string(i);
  std::printf("{\"robot\": \"%s\", \"subject\": \"%s\", \"state\": \"%s\", \"held\": [%s]}\n",
              receipt->robot.str().c_str(), receipt->subject_id.c_str(), sample.state, held.c_str());
  std::fflush(stdout);
}

bool InputClosed() {
  pollfd input{0, POLLIN, 0};
  return poll(&input, 1, 0) > 0;
}

rigcal::Status Record() {
  RIGCAL_ASSIGN(const auto participant, rigcal::wire::Participant::Open({}));
  RIGCAL_ASSIGN(auto reader,
                rigcal::wire::Reader<rigcal_wire_Receipt>::Open(participant, {rigcal::wire::kAllRobotsPartition}));
  RIGCAL_ASSIGN(auto waitset, rigcal::wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(reader.get()));
  std::printf("{\"ready\": true}\n");
  std::fflush(stdout);
  while (!InputClosed()) {
    RIGCAL_TRY(waitset.Wait(std::chrono::milliseconds(200)));
    RIGCAL_TRY(
        reader.Take(64, [](const rigcal_wire_Receipt& sample, const rigcal::wire::SampleOrigin&) { Print(sample); }));
  }
  return {};
}

}  // namespace

int main() {
  const rigcal::Status recorded = Record();
  if (!recorded) std::fprintf(stderr, "%s\n", rigcal::Sentence(recorded.error()).c_str());
  return recorded ? 0 : 1;
}
