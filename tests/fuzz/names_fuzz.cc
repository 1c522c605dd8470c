#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/formats/sessions/payload_path.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

template <typename IdType>
void CheckId(std::string_view text) {
  const auto id = IdType::Parse(text);
  if (!fuzz::RequireGoodError(id)) return;
  fuzz::Require(id->str() == text && text.size() <= 64, "an id is its text");
  fuzz::Require(text.front() != '.' && text.find_first_of("/\\<>&\"' ") == std::string_view::npos,
                "an id is a file name");
}

void CheckTimes(std::string_view text) {
  const auto stamp = ParseIso(text);
  if (fuzz::RequireGoodError(stamp)) {
    const auto again = ParseIso(ToIso(*stamp));
    fuzz::Require(again && *again == *stamp, "a time is written and read again", ToIso(*stamp));
  }
  const auto duration = ParseDuration(text);
  if (fuzz::RequireGoodError(duration)) fuzz::Require(!AgeText(*duration).empty(), "an age has a text");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::TextOf(data, size);
  CheckId<RobotId>(text);
  CheckId<SessionId>(text);
  CheckTimes(text);
  const auto payload = formats::PayloadAt(text);
  if (fuzz::RequireGoodError(payload)) {
    const std::string prefix = payload->sensor.str() + "/" + payload->capture.str() + ".";
    fuzz::Require(payload->path == text && text.substr(0, prefix.size()) == prefix, "a path is of its parts");
  }
  fuzz::Require(IsPrintableUtf8(Quoted(text)) && Quoted(text).size() <= 4 * 80 + 5, "quoted text is printable");
  return 0;
}
