#include "tests/fuzz/document_checks.h"

using namespace rigcal;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto manifest = formats::ReadManifest(fuzz::TextOf(data, size));
  if (!fuzz::RequireGoodError(manifest)) return 0;
  fuzz::Require(Validate(*manifest).has_value(), "a manifest is valid");
  fuzz::RequireRoundTrip(*manifest, formats::WriteManifest, formats::ReadManifest);
  return 0;
}
