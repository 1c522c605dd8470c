#include "tests/fuzz/document_checks.h"

using namespace rigcal;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto edge = formats::ReadEdge(fuzz::TextOf(data, size));
  if (!fuzz::RequireGoodError(edge)) return 0;
  fuzz::CheckEdge(*edge);
  fuzz::RequireRoundTrip(*edge, formats::WriteEdge, formats::ReadEdge);
  return 0;
}
