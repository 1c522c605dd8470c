#include "client/import/rig_map.h"
#include "server/formats/sessions/session_folder.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto map = importing::ReadRigMap(fuzz::TextOf(data, size), "rig.yaml");
  if (!fuzz::RequireGoodError(map)) return 0;
  const std::string yaml = importing::SessionYaml(*map, Stamp{1'700'000'000'000'000'000});
  fuzz::Require(formats::ReadSessionYaml(yaml, "session.yaml").has_value(), "what is written is read", yaml);
  return 0;
}
