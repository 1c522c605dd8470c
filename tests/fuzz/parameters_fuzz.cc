#include "server/formats/answers/parameters.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

void Check(std::string_view json) {
  const auto parameters = formats::Parameters::Read(json);
  const auto with_who = formats::WithParameter(json, "who", "ada");
  fuzz::Require(parameters.has_value() == with_who.has_value(), "one text more changes nothing");
  if (!fuzz::RequireGoodError(parameters)) return;
  if (const auto again = formats::Parameters::Read(*with_who))  // it may be too long by now
    fuzz::Require(again->Text("who") == "ada", "it is there afterwards");
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
