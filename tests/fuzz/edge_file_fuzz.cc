#include "tests/fuzz/document_checks.h"

using namespace rigcal;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto edges = formats::ReadEdgeFile(fuzz::TextOf(data, size), RobotId("mapper-01"));
  if (!fuzz::RequireGoodError(edges)) return 0;
  for (const Edge& edge : *edges) fuzz::CheckEdge(edge);
  if (!edges->empty()) fuzz::RequireRoundTrip(edges->front(), formats::WriteEdge, formats::ReadEdge);
  return 0;
}
