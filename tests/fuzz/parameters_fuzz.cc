#include "server/formats/answers/parameters.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

void Check(std::string_view json) {
  const auto parameters = formats::Parameters::Read(json);
  if (!fuzz::RequireGoodError(parameters)) return;
  for (const char* name : {"robot", "revision", "limit", ""}) {
    (void)parameters->Text(name);
    fuzz::RequireGoodError(parameters->IntegerOr(name, 7));
  }
}

}  // namespace

// As a request's JSON, and as the query of an address.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::TextOf(data, size);
  Check(text);
  const auto json = formats::ParametersOfQuery(text);
  if (fuzz::RequireGoodError(json)) Check(*json);
  return 0;
}
