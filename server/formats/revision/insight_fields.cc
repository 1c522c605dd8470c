#include "server/formats/revision/insight_fields.h"

#include <algorithm>
#include <limits>

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kCyclesMax = 10'000;
constexpr std::int64_t kCountMax = std::numeric_limits<std::int64_t>::max();

void WriteWhyNot(JsonWriter& out, const std::string& why_not) {
  why_not.empty() ? out.Null("why_not") : out.Text("why_not", why_not);
}

std::string ReadWhyNot(const JsonField& field) {
  const auto why_not = field.Find("why_not");
  return why_not ? why_not->Text() : std::string();
}

void WriteCycle(JsonWriter& out, const CycleResidual& cycle) {
  out.Object([&] {
    WriteIds(out, "edges", cycle.edges);
    WriteIds(out, "sensors", cycle.sensors);
    WriteVector(out, "e", cycle.e);
    out.Flag("tested", cycle.tested);
    out.Number("t_squared", cycle.t_squared);
    out.Integer("rank", cycle.rank);
    out.Number("dof", cycle.dof);
    cycle.limit > 0.0 ? out.Number("limit", cycle.limit) : out.Null("limit");
    out.Flag("fails", cycle.fails());
  });
}

CycleResidual ReadCycle(const JsonField& field) {
  CycleResidual cycle;
  cycle.edges = ReadIds<EdgeId>(field.At("edges"), limits::kSensorsPerRobotMax);
  cycle.sensors = ReadIds<SensorId>(field.At("sensors"), limits::kSensorsPerRobotMax);
  if (cycle.edges.size() != cycle.sensors.size()) field.Refuse("must have as many sensors as edges");
  cycle.e = ReadVector(field.At("e"));
  cycle.tested = field.At("tested").Flag();
  cycle.t_squared = field.At("t_squared").Number();
  cycle.rank = static_cast<int>(field.At("rank").Integer(0, 6));
  cycle.dof = field.At("dof").Number();
  if (const auto limit = field.Find("limit")) cycle.limit = limit->Number();
  return cycle;
}

}  // namespace

void WriteInfluence(JsonWriter& out, const Influences& influences, const EdgeId& edge) {
  const auto at = std::lower_bound(influences.edges.begin(), influences.edges.end(), edge,
                                   [](const EdgeInfluence& one, const EdgeId& id) { return one.edge < id; });
  if (at == influences.edges.end() || at->edge != edge) return out.Null("influence");
  out.Object("influence", [&] {
    out.Flag("checked", at->checked);
    out.Number("t_squared", at->t_squared);
    if (at->most_moved.empty()) {
      for (const char* key : {"sensor", "move", "move_sigmas"}) out.Null(key);
      return;
    }
    out.Text("sensor", at->most_moved.str());
    WriteVector(out, "move", at->move);
    out.Number("move_sigmas", at->move_sigmas);
  });
}

EdgeInfluence ReadInfluence(const JsonField& field, const EdgeId& edge) {
  EdgeInfluence influence;
  influence.edge = edge;
  influence.checked = field.At("checked").Flag();
  influence.t_squared = field.At("t_squared").Number();
  const auto sensor = field.Find("sensor");
  if (!sensor) return influence;
  influence.most_moved = ReadId<SensorId>(*sensor);
  influence.move = ReadVector(field.At("move"));
  influence.move_sigmas = field.At("move_sigmas").Number();
  return influence;
}

void WriteInfluenceState(JsonWriter& out, std::string_view key, const Influences& influences) {
  out.Object(key, [&] {
    out.Flag("judged", influences.judged);
    WriteWhyNot(out, influences.why_not);
  });
}

Influences ReadInfluenceState(const JsonField& field) {
  Influences influences;
  influences.judged = field.At("judged").Flag();
  influences.why_not = ReadWhyNot(field);
  return influences;
}

void WriteCycles(JsonWriter& out, std::string_view key, const Cycles& cycles) {
  out.Object(key, [&] {
    out.Flag("judged", cycles.judged);
    WriteWhyNot(out, cycles.why_not);
    out.Integer("examined", cycles.examined);
    out.Integer("tested", cycles.tested);
    out.Integer("failing", cycles.failing);
    out.List("worst", [&] {
      for (const CycleResidual& cycle : cycles.worst) WriteCycle(out, cycle);
    });
  });
}

Cycles ReadCycles(const JsonField& field) {
  Cycles cycles;
  cycles.judged = field.At("judged").Flag();
  cycles.why_not = ReadWhyNot(field);
  cycles.examined = field.At("examined").Integer(0, kCountMax);
  cycles.tested = field.At("tested").Integer(0, kCountMax);
  cycles.failing = field.At("failing").Integer(0, kCountMax);
  for (const JsonField& cycle : field.At("worst").Items(kCyclesMax)) cycles.worst.push_back(ReadCycle(cycle));
  return cycles;
}

}  // namespace rigcal::formats
