#include "server/pipeline/pages/metrics_page.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "server/base/version.h"
#include "server/pipeline/answers/lists.h"
#include "server/pipeline/robots/summaries.h"
#include "storage/fleet/fleet_list.h"
#include "storage/revisions/revisions.h"
#include "storage/sites/forward_queue.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

using metrics::Reading;
using Readings = std::vector<Reading>;

double Seconds(std::int64_t duration_ns) { return static_cast<double>(duration_ns) / 1e9; }

void AddFleet(const FleetCounts& fleet, Readings& readings) {
  const auto add = [&](const std::string& name, const std::string& help, std::int64_t count,
                       std::map<std::string, std::string> labels = {}) {
    readings.push_back({name, help, static_cast<double>(count), std::move(labels)});
  };
  add("rigcal_edges", "Edges in the store", fleet.edges);
  add("rigcal_sessions", "Sessions in the store", fleet.sessions);
  for (const std::string verdict : {"fail", "pass", "unknown", "warn"}) {
    const auto found = fleet.verdicts.find(VerdictLevelOf(verdict));
    add("rigcal_robots", "Robots by the verdict of their newest revision",
        found == fleet.verdicts.end() ? 0 : found->second, {{"verdict", verdict}});
  }
  for (const DriveKind kind : kDriveKinds) {
    const auto found = fleet.kinds.find(kind);
    add("rigcal_robots_by_drive_rule", "Robots by what their drive rule says",
        found == fleet.kinds.end() ? 0 : found->second, {{"rule", NameOf(kind)}});
  }
}

// What the runner would find if it looked now.
Status AddWaiting(storage::Store& store, Stamp now, Readings& readings) {
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(store));
  RIGCAL_ASSIGN(const auto oldest, storage::LoadOldestQueuedAt(store));
  RIGCAL_ASSIGN(const auto unpublished, storage::LoadUnpublished(store));
  RIGCAL_ASSIGN(const auto unsolved, storage::LoadUnsolvedRobots(store));
  const double oldest_s = oldest ? std::max(0.0, Seconds(now.ns - oldest->ns)) : 0.0;
  readings.push_back({"rigcal_jobs_waiting", "Pairs that are to be calibrated", static_cast<double>(jobs)});
  readings.push_back(
      {"rigcal_oldest_job_waiting_seconds", "How long the oldest of them has waited; 0: none waits", oldest_s});
  readings.push_back(
      {"rigcal_reports_waiting", "Revisions whose report is to be drawn", static_cast<double>(unpublished.size())});
  readings.push_back(
      {"rigcal_robots_waiting", "Robots with edges that are in no revision", static_cast<double>(unsolved.size())});
  return {};
}

// Of a server that is no site's they are 0.
Status AddForward(storage::Store& store, Stamp now, Readings& readings) {
  RIGCAL_ASSIGN(const auto found, storage::LoadForwardState(store));
  const ForwardState state = found.value_or(ForwardState{});
  const double oldest_s = state.oldest_at ? std::max(0.0, Seconds(now.ns - state.oldest_at->ns)) : 0.0;
  readings.push_back({"rigcal_forward_waiting", "Sessions and batches of edges that are not at the centre yet",
                      static_cast<double>(state.sessions_waiting + state.batches_waiting)});
  readings.push_back(
      {"rigcal_forward_oldest_waiting_seconds", "How long the oldest of them has waited; 0: none waits", oldest_s});
  readings.push_back(
      {"rigcal_forward_failing", "1: the centre is not reached or takes nothing", state.failing_since ? 1.0 : 0.0});
  return {};
}

void AddHealth(const formats::HealthAnswer& health, Readings& readings) {
  readings.push_back(
      {"rigcal_disk_free_bytes", "Room on the disk of the data folder", static_cast<double>(health.disk_free_bytes)});
  for (const PartState& part : health.parts) {
    readings.push_back({"rigcal_part_failing",
                        "1: this part of the server does not do its work (/healthz says why)",
                        part.problem ? 1.0 : 0.0,
                        {{"part", part.name}}});
    readings.push_back({"rigcal_part_failures_total",
                        "Failures of this part of the server",
                        static_cast<double>(part.failures),
                        {{"part", part.name}}});
  }
}

void AddProcess(Readings& readings) {
  std::int64_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  std::error_code unreadable;
  const std::filesystem::directory_iterator handles("/proc/self/fd", unreadable);
  readings.push_back({"rigcal_resident_memory_bytes", "Memory of the server, without the processes that work for it",
                      static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE))});
  readings.push_back({"rigcal_open_handles", "Files, sockets and pipes that the server has open",
                      static_cast<double>(std::distance(begin(handles), end(handles)))});
  readings.push_back({"rigcal_build_info", "Always 1: which version runs", 1.0, {{"version", std::string(Version())}}});
}

}  // namespace

Result<PageText> AnswerMetrics(const AnswerContext& context) {
  const Stamp now = context.clock.Now();
  static_cast<void>(FreshenSummaries(context.store, context.clock));  // what could not be kept is there soon
  Readings readings = {
      {"rigcal_uptime_seconds", "Since the server was started", Seconds(now.ns - context.started_at.ns)}};
  AddHealth(LookAtHealth(context), readings);
  AddProcess(readings);
  RIGCAL_ASSIGN(const FleetCounts fleet, storage::CountFleet(context.store, now));
  AddFleet(fleet, readings);
  RIGCAL_TRY(AddWaiting(context.store, now, readings));
  RIGCAL_TRY(AddForward(context.store, now, readings));
  RIGCAL_ASSIGN(const auto alerts, AlertReadings(context.store, fleet));
  readings.insert(readings.end(), alerts.begin(), alerts.end());
  if (context.more_readings)
    for (Reading& more : context.more_readings()) readings.push_back(std::move(more));
  return PageText{metrics::TextOf(readings), metrics::kContentType};
}

}  // namespace rigcal::pipeline
