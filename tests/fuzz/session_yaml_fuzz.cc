#include "server/formats/sessions/session_folder.h"
#include "tests/fuzz/document_checks.h"

using namespace rigcal;

// With one file of its first sensor, a header makes a manifest.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto header = formats::ReadSessionYaml(fuzz::TextOf(data, size), "session.yaml");
  if (!fuzz::RequireGoodError(header)) return 0;
  fuzz::Require(Validate(*header).has_value(), "a session is valid");
  const Sensor& sensor = header->sensors.front();
  const auto& suffixes = SuffixesOf(sensor.kind);
  const bool table = suffixes.front() == "csv";
  const CaptureId capture(table ? std::string(kPoseTableStem) : "01");
  const std::string path = sensor.id.str() + "/" + capture.str() + "." + std::string(suffixes.front());
  const Manifest manifest{*header, {{path, sensor.id, capture, Digest(std::string(64, 'a')), 1}}};
  fuzz::RequireRoundTrip(manifest, formats::WriteManifest, formats::ReadManifest);
  return 0;
}
