#include "server/model/edges/admission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigcal {
namespace {

using testing::HasSubstr;

// 2 sensors, 3 files of 1000 bytes.
Manifest Small() {
  Manifest manifest;
  manifest.header.sensors.resize(2);
  for (const char* path : {"left/1.png", "left/2.png", "right/1.png"}) {
    Payload payload;
    payload.path = path;
    payload.size_bytes = 1000;
    manifest.payloads.push_back(payload);
  }
  return manifest;
}

std::string Refusal(const limits::Limits& limits) {
  const Status status = CheckAdmission(Small(), limits);
  return status ? "" : Sentence(status.error());
}

TEST(Admission, TheLimitItselfIsAdmitted) {
  limits::Limits limits;
  EXPECT_EQ(Refusal(limits), "");
  limits.sensors_per_session = 2;
  limits.payloads_per_session = 3;
  limits.payload_bytes = 1000;
  limits.session_bytes = 3000;
  EXPECT_EQ(Refusal(limits), "");
}

TEST(Admission, BeyondItNamesTheLimitAndTheFile) {
  limits::Limits sensors, files, file, session;
  sensors.sensors_per_session = 1;
  files.payloads_per_session = 2;
  file.payload_bytes = 999;
  session.session_bytes = 2999;
  EXPECT_THAT(Refusal(sensors), HasSubstr("2, beyond this server's limit of 1"));
  EXPECT_THAT(Refusal(sensors), HasSubstr("sensors_per_session"));
  EXPECT_THAT(Refusal(files), HasSubstr("raise the limit payloads_per_session"));
  EXPECT_THAT(Refusal(file), HasSubstr("\"left/1.png\" has too many bytes, 1000"));
  EXPECT_THAT(Refusal(session), HasSubstr("the session has too many bytes, 3000"));
}

TEST(Admission, AClockMayBeADayAhead) {
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  const Stamp now = *ParseIso("2026-01-31T12:00:00Z");
  SessionHeader header;
  header.captured_at = {now.ns + kDay_ns};
  EXPECT_TRUE(CheckCapturedAt(header, now));
  header.captured_at = {0};
  EXPECT_TRUE(CheckCapturedAt(header, now));
  header.captured_at = {now.ns + kDay_ns + 1'000'000'000};
  const Status refused = CheckCapturedAt(header, now);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("2026-02-01T12:00:01Z"));
  EXPECT_THAT(refused.error().what, HasSubstr("2026-01-31T12:00:00Z"));
}

TEST(Admission, AnEdgeOfTheFutureIsRefused) {
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  const Stamp now = *ParseIso("2026-01-31T12:00:00Z");
  Edge edge;
  edge.frame_a = SensorId("left"), edge.frame_b = SensorId("right");
  EXPECT_TRUE(CheckMeasuredAt(edge, now));
  edge.measured_at = Stamp{now.ns + kDay_ns};
  EXPECT_TRUE(CheckMeasuredAt(edge, now));
  edge.measured_at = Stamp{now.ns + kDay_ns + 1'000'000'000};
  const Status refused = CheckMeasuredAt(edge, now);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what,
              HasSubstr("edge left - right: measured_at 2026-02-01T12:00:01Z is more than a day ahead"));
}

}  // namespace
}  // namespace rigcal
