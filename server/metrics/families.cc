#include "server/metrics/families.h"

#include <memory>

namespace rigcal::metrics {
namespace {

using prometheus::Counter;
using prometheus::Family;
using prometheus::Histogram;
using prometheus::Registry;

// From a small picture to hours of work on a large session.
const Histogram::BucketBoundaries kStageBounds_s = {0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000, 3600, 10800};
const Histogram::BucketBoundaries kAnswerBounds_s = {0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1,
                                                     0.2,    0.5,   1,     2,     5,    10,   60};

Family<Counter>& CounterFamily(Registry& registry, const std::string& name, const std::string& help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

void StartAtZero(Family<Counter>& family, const std::string& label, const std::vector<std::string>& values) {
  for (const std::string& value : values) family.Add({{label, value}});
}

std::vector<std::string> ErrorKinds() {
  std::vector<std::string> kinds;
  for (const ErrorCode code :
       {ErrorCode::kInvalidInput, ErrorCode::kNotFound, ErrorCode::kConflict, ErrorCode::kBusy, ErrorCode::kUnreachable,
        ErrorCode::kUnsupported, ErrorCode::kStorage, ErrorCode::kInternal})
    kinds.push_back(rigcal::NameOf(code));
  return kinds;
}

}  // namespace

std::string NameOf(Channel channel) { return channel == Channel::kDds ? "dds" : "http"; }

Families::Families()
    : stage_failures(CounterFamily(registry, "rigcal_stage_failures_total",
                                   "Pieces of work that failed, by stage; most are tried again")),
      answer_failures(CounterFamily(registry, "rigcal_answer_failures_total",
                                    "Questions that were answered with an error, by channel and kind")),
      receipts(
          CounterFamily(registry, "rigcal_receipts_total", "Receipts that were sent to clients that push, by state")),
      refusals(
          CounterFamily(registry, "rigcal_refusals_total", "Pushes and orders that were refused, by kind of error")),
      edges_calibrated(
          CounterFamily(registry, "rigcal_edges_calibrated_total", "Edges that were made of sessions, by state")),
      revisions(CounterFamily(registry, "rigcal_revisions_total", "Revisions that were made, by verdict")),
      errors(CounterFamily(registry, "rigcal_errors_total", "Errors that were logged, by kind")),
      received_bytes(
          CounterFamily(registry, "rigcal_received_bytes_total", "Bytes of pictures and clouds that became durable")
              .Add({})),
      edges_pushed(
          CounterFamily(registry, "rigcal_edges_pushed_total", "Finished edges that were pushed and became durable")
              .Add({})) {
  auto& stages = prometheus::BuildHistogram()
                     .Name("rigcal_stage_duration_seconds")
                     .Help("How long pieces of work took, by stage")
                     .Register(registry);
  for (const Stage stage : kStages) {
    stage_duration[stage] = &stages.Add({{"stage", NameOf(stage)}}, kStageBounds_s);
    StartAtZero(stage_failures, "stage", {NameOf(stage)});
  }
  auto& answers = prometheus::BuildHistogram()
                      .Name("rigcal_answer_duration_seconds")
                      .Help("How long questions waited for their answers")
                      .Register(registry);
  for (const Channel channel : {Channel::kDds, Channel::kHttp}) {
    answer_duration[channel] = &answers.Add({{"channel", NameOf(channel)}}, kAnswerBounds_s);
    for (const std::string& kind : ErrorKinds()) answer_failures.Add({{"channel", NameOf(channel)}, {"kind", kind}});
  }
  StartAtZero(receipts, "state", {"closed", "need_manifest", "receiving", "refused"});
  StartAtZero(refusals, "kind", ErrorKinds());
  StartAtZero(edges_calibrated, "state", {"failed", "good"});
  StartAtZero(revisions, "verdict", {"fail", "pass", "unknown", "warn"});
  StartAtZero(errors, "kind", ErrorKinds());
}

Families& TheFamilies() {
  static Families& families = *std::make_unique<Families>().release();
  return families;
}

}  // namespace rigcal::metrics
