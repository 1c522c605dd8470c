// DDS itself fails: a wait, or a take. The threads tell it, pause, and go on; nothing that came meanwhile is lost.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/unit/dds/fixture.h"

namespace {

std::atomic<bool> waits_fail{false}, takes_fail{false};
thread_local bool is_client = false;  // whose own calls never fail

}  // namespace

// Found before the library's own, as symbols of the executable.
extern "C" dds_return_t dds_waitset_wait(dds_entity_t waitset, dds_attach_t* attached, std::size_t count,
                                         dds_duration_t timeout) {
  if (waits_fail && !is_client) return DDS_RETCODE_ERROR;
  static const auto next = reinterpret_cast<decltype(&dds_waitset_wait)>(dlsym(RTLD_NEXT, "dds_waitset_wait"));
  return next(waitset, attached, count, timeout);
}

extern "C" dds_return_t dds_take(dds_entity_t reader, void** samples, dds_sample_info_t* infos, std::size_t size,
                                 std::uint32_t max) {
  if (takes_fail && !is_client) return DDS_RETCODE_ERROR;
  static const auto next = reinterpret_cast<decltype(&dds_take)>(dlsym(RTLD_NEXT, "dds_take"));
  return next(reader, samples, infos, size, max);
}

namespace rigcal::dds {
namespace {

class DdsFaultTest : public ServiceTest {
 protected:
  DdsFaultTest() {
    is_client = true;
    options_.vitals = &vitals_;
  }
  ~DdsFaultTest() override {
    waits_fail = takes_fail = false;
    StopServer();
  }

  [[nodiscard]] PartState Intake() const {
    for (PartState& part : vitals_.States())
      if (part.name == "intake") return part;
    throw std::runtime_error("there is no intake");
  }
  void Await(const std::function<bool(const PartState&)>& done) const {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!done(Intake()) && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
    EXPECT_TRUE(done(Intake()));
  }

  Vitals vitals_{SystemClock()};
};

TEST_F(DdsFaultTest, FailedWaitIsToldAndWhatComesIsTaken) {
  Client client = MakeClient("mapper-01");
  waits_fail = true;
  Await([](const PartState& intake) { return intake.problem && intake.failures >= 3; });
  client.Push(MakeSession("mapper-01", {1'000, 2'000}, 1));
  EXPECT_TRUE(Intake().problem);
  waits_fail = false;
  Await([](const PartState& intake) { return !intake.problem; });
  client.Push(MakeSession("mapper-01", {1'000, 2'000}, 2));
}

TEST_F(DdsFaultTest, FailedTakeIsToldAndLosesNothing) {
  Client client = MakeClient("mapper-01");
  const Session session = MakeSession("mapper-01", {1'000, 2'000}, 3);
  takes_fail = true;
  client.SendHeader(session);
  Await([](const PartState& intake) { return intake.problem && intake.failures >= 3; });
  takes_fail = false;
  client.AwaitState(session.id.str(), wire::ReceiptState::kNeedManifest);
  Await([](const PartState& intake) { return !intake.problem; });
  client.Push(session);
}

TEST_F(DdsFaultTest, FailingThreadsPause) {
  waits_fail = true;
  Await([](const PartState& intake) { return intake.failures >= 1; });
  const auto start = std::chrono::steady_clock::now();
  const std::int64_t before = Intake().failures;
  Await([&](const PartState& intake) { return intake.failures >= before + 5; });
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(400));
}

TEST_F(DdsFaultTest, StopsWhileItFails) {
  waits_fail = takes_fail = true;
  Await([](const PartState& intake) { return intake.failures >= 1; });
  StopServer();
}

}  // namespace
}  // namespace rigcal::dds
