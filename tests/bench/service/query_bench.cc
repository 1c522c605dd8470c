// Round trips of one query against a running rigcald, from inside one process. Prints one JSON object.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "client/wire/connection.h"
#include "server/base/process/thread_rank.h"

namespace {

struct Options {
  rigcal::wire::ParticipantOptions participant;
  std::string robot, a, b;
  int count = 1000;
};

rigcal::Result<std::vector<double>> RoundTrips(const Options& options) {
  RIGCAL_ASSIGN(const auto participant, rigcal::wire::Participant::Open(options.participant));
  RIGCAL_ASSIGN(auto connection, rigcal::client::Connection::Open(participant, options.participant));
  const std::string json = rigcal::client::JsonObject({{"robot", options.robot}, {"a", options.a}, {"b", options.b}});
  constexpr std::chrono::milliseconds kTimeout(5000);
  RIGCAL_TRY(connection.Ask("lookup", json, kTimeout));
  std::vector<double> times_ms;
  for (int i = 0; i < options.count; ++i) {
    const auto start = std::chrono::steady_clock::now();
    RIGCAL_TRY(connection.Ask("lookup", json, kTimeout));
    times_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times_ms.begin(), times_ms.end());
  return times_ms;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Round trips of `lookup` inside one process");
  app.add_option("--tag", options.participant.tag);
  app.add_option("--domain", options.participant.domain);
  app.add_option("--robot", options.robot)->required();
  app.add_option("--a", options.a)->required();
  app.add_option("--b", options.b)->required();
  app.add_option("--count", options.count)->check(CLI::Range(1, 1000000));
  CLI11_PARSE(app, argc, argv);
  // As if on a machine of its own: its own waiting for a processor is not the service's.
  rigcal::SetThreadRank(rigcal::ThreadRank::kAnswers);
  const auto times_ms = RoundTrips(options);
  if (!times_ms) {
    std::fprintf(stderr, "%s\n", rigcal::Sentence(times_ms.error()).c_str());
    return 1;
  }
  const auto at = [&](double share) {
    return (*times_ms)[static_cast<std::size_t>(share * static_cast<double>(times_ms->size() - 1))];
  };
  std::printf("{\"median_ms\": %.4f, \"p99_ms\": %.4f, \"max_ms\": %.4f, \"count\": %zu}\n", at(0.5), at(0.99), at(1.0),
              times_ms->size());
  return 0;
}
