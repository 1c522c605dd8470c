#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "server/base/limits.h"
#include "server/model/sessions/session.h"

namespace rigcal {
namespace {

using ::testing::HasSubstr;

Payload File(const std::string& path, const char* sensor, const char* capture) {
  return {path, SensorId(sensor), CaptureId(capture), Digest(std::string(64, 'a')), 1000};
}

Manifest GoodManifest() {
  Manifest manifest;
  manifest.header.robot = RobotId("mapper-01");
  manifest.header.reference = SensorId("left");
  manifest.header.sensors.resize(2);
  manifest.header.sensors[0].id = SensorId("left");
  manifest.header.sensors[1].id = SensorId("right");
  manifest.header.targets = {{TargetId("board"), 9, 6, 0.025, 0.0, ""}};
  manifest.payloads = {File("left/001.png", "left", "001"), File("left/002.jpg", "left", "002"),
                       File("right/001.jpeg", "right", "001")};
  return manifest;
}

std::string ManifestRefusalAfter(const std::function<void(Manifest&)>& change) {
  Manifest manifest = GoodManifest();
  change(manifest);
  const Status status = Validate(manifest);
  if (status) return "";
  EXPECT_FALSE(status.error().cure.empty());
  return status.error().what;
}

TEST(ValidateManifest, AcceptsAGoodOne) {
  EXPECT_EQ(ManifestRefusalAfter([](Manifest&) {}), "");
}

TEST(ValidateManifest, ThePathIsThatOfSensorAndCapture) {
  for (const char* path : {"", "001.png", "/left/001.png", "left/../001.png", "left//001.png", "left/001.tiff",
                           "left/001.png ", "left/001", "right/001.png", "left/002.png", "left\\001.png"})
    EXPECT_THAT(ManifestRefusalAfter([&](auto& m) { m.payloads[0].path = path; }), HasSubstr("the path is not"))
        << path;
}

TEST(ValidateManifest, NamesTheFile) {
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads[1].size_bytes = 0; }),
              HasSubstr("\"left/002.jpg\": it is empty"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads[1].size_bytes = limits::kPayloadBytesMax + 1; }),
              HasSubstr("\"left/002.jpg\": it is larger"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads[1].digest = Digest("12"); }), HasSubstr("left/002.jpg"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads[1] = File("top/002.jpg", "top", "002"); }),
              HasSubstr("sensor top is not in the session"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads[1] = File("../002.jpg", "..", "002"); }),
              HasSubstr("sensor id"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads[1] = File("left/...jpg", "left", ".."); }),
              HasSubstr("capture id"));
}

TEST(ValidateManifest, FilesAreSortedAndSingle) {
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { std::swap(m.payloads[0], m.payloads[1]); }),
              HasSubstr("out of order"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads[1] = m.payloads[0]; }), HasSubstr("listed twice"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) {
                m.payloads[0] = File("left/001.jpg", "left", "001");
                m.payloads[1] = File("left/001.png", "left", "001");
              }),
              HasSubstr("another file for capture 001"));
}

TEST(ValidateManifest, CountsAndBytesAreBounded) {
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads.clear(); }), HasSubstr("0 files"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.payloads.resize(limits::kPayloadsPerSessionMax + 1); }),
              HasSubstr("100001 files"));
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) {
                m.payloads.clear();
                for (int i = 100; i < 300; ++i) {
                  m.payloads.push_back(File("left/" + std::to_string(i) + ".png", "left", std::to_string(i).c_str()));
                  m.payloads.back().size_bytes = limits::kPayloadBytesMax;
                }
              }),
              HasSubstr("the session holds"));
}

TEST(ValidateManifest, TheHeaderIsCheckedToo) {
  EXPECT_THAT(ManifestRefusalAfter([](auto& m) { m.header.reference = SensorId("top"); }),
              HasSubstr("reference sensor"));
}

}  // namespace
}  // namespace rigcal
