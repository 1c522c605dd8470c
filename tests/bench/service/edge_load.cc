// Finished edges of many robots, pushed without a pause by several clients at once, at no more than a given rate: the
// edges of a file, each time a little elsewhere. Prints one JSON object at its end.
#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <limits>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "client/text/progress.h"
#include "client/wire/edge_outlet.h"
#include "server/base/files/durable_file.h"
#include "server/formats/documents.h"
#include "server/model/edges/edge.h"

namespace rigcal {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  wire::ParticipantOptions participant;
  std::string file;
  int robots = 8, clients = 8, batches = std::numeric_limits<int>::max();
  double edges_per_s = 5000.0, seconds = 10.0;
};

struct Load {
  Load(Options given, std::vector<Edge> of_file) : options(std::move(given)), edges_of_file(std::move(of_file)) {}

  const Options options;
  const std::vector<Edge> edges_of_file;
  Clock::time_point began = Clock::now();
  std::atomic<std::int64_t> edges{0}, batches{0};
  std::mutex mutex;
  std::condition_variable failed_now;
  bool failed = false;

  // The clients together keep to the rate. False: one of them has failed.
  bool WaitForTurn() {
    const auto turn = began + std::chrono::duration<double>(static_cast<double>(edges) / options.edges_per_s);
    std::unique_lock lock(mutex);
    return !failed_now.wait_until(lock, turn, [&] { return failed; });
  }
  void Fail() {
    const std::lock_guard lock(mutex);
    failed = true;
    failed_now.notify_all();
  }
};

// A tenth of a millimetre and of a milliradian apart from the file's, so that no two are the same content.
std::vector<Edge> Shaken(const Load& load, const RobotId& robot, std::mt19937_64& random) {
  std::vector<Edge> edges = load.edges_of_file;
  std::normal_distribution<double> draw(0.0, 1e-4);
  for (Edge& edge : edges) {
    edge.robot = robot;
    Vector6d shift;
    for (double& value : shift) value = draw(random);
    edge.T_a_b = edge.T_a_b * Se3::Exp(shift);
  }
  AssignPushedIds(edges);
  return edges;
}

Status Push(const wire::Participant& participant, const RobotId& robot, std::vector<Edge> edges) {
  const client::EdgesToPush batch = client::EdgesOf(robot, std::move(edges), std::nullopt);
  RIGCAL_ASSIGN(const auto outlet, client::EdgeOutlet::Open(participant, batch));
  client::PushPlan plan = client::BatchPlan(batch.edges.size(), 2000);
  plan.send_order = batch.send_order;
  client::PushEngine engine(std::move(plan), client::SteadyNow_ns());
  const client::TransferHooks quiet{[](const client::PushEngine&, std::int64_t) {}, [](const std::string&) {}};
  return client::RunTransfer(participant, {robot, batch.id.str(), "edge_load"}, engine, *outlet, quiet);
}

Status PushAll(Load& load, int client) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(load.options.participant));
  std::mt19937_64 random(static_cast<std::uint64_t>(client));
  const auto until = load.began + std::chrono::duration<double>(load.options.seconds);
  for (int turn = client; turn < load.options.batches && Clock::now() < until && load.WaitForTurn();
       turn += load.options.clients) {
    const RobotId robot("load-" + std::to_string(turn % load.options.robots));
    RIGCAL_TRY(Push(participant, robot, Shaken(load, robot, random)));
    load.edges += static_cast<std::int64_t>(load.edges_of_file.size()), ++load.batches;
  }
  return {};
}

Result<std::vector<Edge>> EdgesOfFile(const std::string& file) {
  RIGCAL_ASSIGN(const std::string text, ReadFile(file, limits::kG2oFileBytesMax));
  return formats::ReadEdgeFile(text, RobotId("load-0"));
}

int Run(const Options& options) {
  auto edges = EdgesOfFile(options.file);
  if (!edges) return std::fprintf(stderr, "%s\n", Sentence(edges.error()).c_str()), 1;
  Load load(options, std::move(*edges));
  std::vector<std::thread> clients;
  for (int i = 0; i < options.clients; ++i)
    clients.emplace_back([&load, i] {
      const Status done = PushAll(load, i);
      if (done) return;
      load.Fail();
      std::fprintf(stderr, "%s\n", Sentence(done.error()).c_str());
    });
  for (std::thread& one : clients) one.join();
  const double took_s = std::chrono::duration<double>(Clock::now() - load.began).count();
  std::printf("{\"edges\": %lld, \"batches\": %lld, \"seconds\": %.3f, \"edges_per_s\": %.1f}\n",
              static_cast<long long>(load.edges), static_cast<long long>(load.batches), took_s,
              static_cast<double>(load.edges) / took_s);
  return load.failed ? 1 : 0;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  rigcal::Options options;
  CLI::App app("Pushes finished edges of many robots at a given rate");
  app.add_option("--tag", options.participant.tag);
  app.add_option("--file", options.file, "As for rigcal push-edges")->required();
  app.add_option("--robots", options.robots)->check(CLI::Range(1, 100000));
  app.add_option("--clients", options.clients)->check(CLI::Range(1, 64));
  app.add_option("--batches", options.batches, "As many and no more")->check(CLI::PositiveNumber);
  app.add_option("--edges-per-s", options.edges_per_s)->check(CLI::Range(1.0, 1e7));
  app.add_option("--seconds", options.seconds)->check(CLI::Range(0.1, 3600.0));
  CLI11_PARSE(app, argc, argv);
  return rigcal::Run(options);
}
