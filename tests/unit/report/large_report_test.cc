// The page of a revision with thousands of sensors: small, quick, and it says what it leaves out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "server/base/digests/sha256.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;

ReportInput BigReport(int sensors, int edges) {
  ReportInput input = SampleReport();
  auto& revision = input.revision;
  revision.edges.clear();
  revision.solution.poses.clear();
  revision.solution.residuals.clear();
  revision.reference = SensorId("s0");
  for (int i = 0; i < sensors; ++i)
    AddPose(revision, "s" + std::to_string(i), true, SamplePose(100 * std::cos(i), 100 * std::sin(i), 0.01 * i, i),
            0.01);
  for (int i = 0; i < edges; ++i) {
    Edge edge = SampleEdge("s" + std::to_string(i % sensors), "s" + std::to_string((i * 7 + 1) % sensors), Se3());
    edge.id = EdgeId(Sha256Of(std::to_string(i)).str());
    revision.solution.residuals.push_back({edge.id, true, Vector6d::Constant(1e-3), 0.5});
    revision.edges.push_back(std::move(edge));
  }
  return input;
}

std::string PageOfLarge(const ReportInput& input) { return RenderRevision(input, "{}").value().at("index.html"); }

double RenderSeconds(const ReportInput& input, std::size_t& bytes) {
  const auto start = std::chrono::steady_clock::now();
  bytes = PageOfLarge(input).size();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(LargeReport, StaysSmallAndFast) {
  std::size_t bytes = 0;
  const double seconds = RenderSeconds(BigReport(2500, 5000), bytes);
  RecordProperty("seconds", std::to_string(seconds));
  RecordProperty("bytes", std::to_string(bytes));
  EXPECT_LT(bytes, 5'000'000U);
  EXPECT_LT(seconds, 2.0);
}

TEST(LargeReport, BeyondThePageTheDocumentIsNamed) {
  ReportInput input = BigReport(9000, 20000);
  for (Edge& edge : input.revision.edges) {
    edge.state = EdgeState::kFailed;
    edge.diagnoses = {{"code", std::string(100, 'w'), std::string(100, 'c')}};
  }
  std::size_t bytes = 0;
  (void)RenderSeconds(input, bytes);
  EXPECT_LT(bytes, 5'000'000U);
  EXPECT_THAT(PageOfLarge(input), HasSubstr("more sensors are in <a href=\"revision.json\">"));
  EXPECT_THAT(PageOfLarge(input), HasSubstr("Details of "));
}

}  // namespace
}  // namespace rigcal::report
