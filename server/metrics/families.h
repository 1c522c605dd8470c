// The one registry of the process: which counters and histograms there are, by which names and labels. Of this module
// alone.
#pragma once

#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <map>
#include <string>

#include "server/metrics/noted.h"

namespace rigcal::metrics {

struct Families {
  Families();
  // Every value of a label that is known is there from the start, at zero.
  prometheus::Registry registry;
  std::map<Stage, prometheus::Histogram*> stage_duration;
  std::map<Channel, prometheus::Histogram*> answer_duration;
  prometheus::Family<prometheus::Counter>&stage_failures, &answer_failures, &receipts, &refusals, &edges_calibrated,
      &revisions, &errors;
  prometheus::Counter &received_bytes, &edges_pushed;
};
// Made with the first call and never destroyed: threads may note until the very end of the process.
[[nodiscard]] Families& TheFamilies();

[[nodiscard]] std::string NameOf(Channel channel);  // "dds", "http"

}  // namespace rigcal::metrics
