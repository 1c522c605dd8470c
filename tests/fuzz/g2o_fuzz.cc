#include "server/formats/edges/g2o.h"
#include "tests/fuzz/document_checks.h"

using namespace rigcal;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = formats::ReadG2o(fuzz::TextOf(data, size), RobotId("mapper-01"));
  if (!fuzz::RequireGoodError(file)) return 0;
  for (const Edge& edge : file->edges) fuzz::CheckEdge(edge);
  for (const auto& [vertex, T_world_vertex] : file->T_world_vertex) fuzz::RequireFinite(T_world_vertex.p_m, "vertex");
  return 0;
}
