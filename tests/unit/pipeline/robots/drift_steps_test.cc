// Which visits the date by drift is learnt from.
#include <gtest/gtest.h>

#include "server/pipeline/robots/robot_status.h"
#include "storage/alerts/revision_status.h"
#include "storage/revisions/as_found.h"
#include "storage/sessions/epochs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

const SensorId kTop("top");

class DriftStepsTest : public PipelineTest {
 protected:
  // A revision of a visit a week after the one before, which found top moved by so much of the calibration in use.
  void Visit(double moved_m) {
    clock_.now.ns += 7 * kDay_ns;
    Manifest manifest;
    manifest.header.robot = kRig;
    manifest.header.captured_at = clock_.now;
    manifest.header.operator_name = "visit " + std::to_string(visits_);
    AsFound found;
    found.session = Close(manifest);
    found.captured_at = clock_.now;
    found.in_use = visits_++;
    found.visits = 3;
    found.relative_to = kCameras.front();
    SensorFound& top = found.sensors.emplace_back();
    top.sensor = kTop;
    top.state = moved_m > 1e-3 ? FoundState::kDrifted : FoundState::kUnchanged;
    top.axes.fill(top.state);
    top.change(0) = moved_m;
    top.sigma.setConstant(2e-4);
    Revision revision;
    revision.robot = kRig;
    revision.verdict.level = VerdictLevel::kPass;
    revision.document = "{\"of\":" + std::to_string(visits_) + "}";
    revision.digest = Sha256Of(revision.document);
    revision.calibrated_at = clock_.now;
    const Status kept = store_->Write([&]() -> Status {
      RIGCAL_ASSIGN(const int number, storage::AppendRevision(*store_, revision));
      RIGCAL_TRY(storage::AppendAsFound(*store_, {kRig, number}, found));
      return storage::AppendModelVisit(*store_, "mars", {kRig, number}, found.session);
    });
    ASSERT_TRUE(kept) << Sentence(kept.error());
  }
  // By when it is due, as a revision has it that is made now.
  std::optional<DriftDue> Due() {
    formats::RevisionInput made;
    made.robot = kRig;
    made.reference = kCameras.front();
    for (const SensorId& sensor : {kCameras.front(), kTop}) {
      SensorPose& pose = made.solution.poses.emplace_back();
      pose.sensor = sensor;
      pose.known = true;
    }
    PolicyInForce policy;
    policy.rig_model = "mars";
    const auto facts = FindStatus(*store_, {made, policy, std::nullopt, clock_.now, kDefaultMaxAge_ns, {}});
    EXPECT_TRUE(facts) << Sentence(facts.error());
    return facts ? DriftDueOf(*facts) : std::nullopt;
  }
  int visits_ = 0;
};

TEST_F(DriftStepsTest, WhatWasMovedOnPurposeIsNoneWheneverThatWasSaid) {
  for (const double moved_m : {0.0, 1e-5, 2e-5, 1e-5, 8e-3}) Visit(moved_m);
  const Stamp bumped = clock_.now;
  ASSERT_TRUE(Due()) << "a bump is a change as any other";
  const Word word{clock_.now, "Ada", "new bracket"};
  const auto say = [&](const SensorId& sensor, Stamp begins_at) {
    ASSERT_TRUE(storage::BeginEpoch(*store_, kRig, {sensor}, begins_at, word));
  };
  say(kCameras.back(), Stamp{bumped.ns - kDay_ns});
  EXPECT_TRUE(Due()) << "another sensor";
  say(kTop, bumped);
  EXPECT_TRUE(Due()) << "after that visit";
  say(kTop, Stamp{bumped.ns - kDay_ns});
  EXPECT_FALSE(Due());
}

}  // namespace
}  // namespace rigcal::pipeline
