#include "server/metrics/exposition.h"

#include <prometheus/text_serializer.h>

#include <algorithm>
#include <sstream>

#include "server/metrics/families.h"

namespace rigcal::metrics {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;

bool OnlyGrows(const std::string& name) {
  const std::string_view end = "_total";
  return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

ClientMetric MetricOf(const Reading& reading) {
  ClientMetric metric;
  for (const auto& [name, value] : reading.labels) metric.label.push_back({name, value});
  (OnlyGrows(reading.name) ? metric.counter.value : metric.gauge.value) = reading.value;
  return metric;
}

void Add(const Reading& reading, std::map<std::string, MetricFamily>& families) {
  MetricFamily& family = families[reading.name];
  if (family.name.empty())
    family = {reading.name, reading.help, OnlyGrows(reading.name) ? MetricType::Counter : MetricType::Gauge, {}};
  ClientMetric metric = MetricOf(reading);
  const auto same = [&](const ClientMetric& other) { return other.label == metric.label; };
  if (std::none_of(family.metric.begin(), family.metric.end(), same)) family.metric.push_back(std::move(metric));
}

}  // namespace

std::string TextOf(const std::vector<Reading>& readings) {
  std::map<std::string, MetricFamily> by_name;
  for (MetricFamily& noted : TheFamilies().registry.Collect()) {
    const std::string name = noted.name;
    by_name.emplace(name, std::move(noted));
  }
  for (const Reading& reading : readings) Add(reading, by_name);
  std::vector<MetricFamily> families;
  for (auto& [name, family] : by_name) {
    std::sort(family.metric.begin(), family.metric.end(),
              [](const ClientMetric& a, const ClientMetric& b) { return a.label < b.label; });
    families.push_back(std::move(family));
  }
  std::ostringstream text;
  prometheus::TextSerializer().Serialize(text, families);
  return text.str();
}

}  // namespace rigcal::metrics
