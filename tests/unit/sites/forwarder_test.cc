// What waits in a store is sent in its order, whatever becomes of the centre meanwhile.
#include "server/sites/forwarder.h"

#include <chrono>
#include <mutex>

#include "server/formats/sites/forward.h"
#include "storage/sites/forward_queue.h"
#include "tests/unit/http/client.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::sites {
namespace {

TEST(LinkRetry, DoublesUpToAMinute) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  EXPECT_EQ(LinkRetryAfter_ns(1), kSecond_ns);
  EXPECT_EQ(LinkRetryAfter_ns(2), 2 * kSecond_ns);
  EXPECT_EQ(LinkRetryAfter_ns(6), 32 * kSecond_ns);
  EXPECT_EQ(LinkRetryAfter_ns(7), 60 * kSecond_ns);
  EXPECT_EQ(LinkRetryAfter_ns(1'000'000), 60 * kSecond_ns);
}

class ForwarderTest : public storage::StoreTest {
 protected:
  SessionId CloseSession(std::size_t payloads) {
    const Manifest manifest = storage::MakeManifest(payloads);
    const SessionId id = storage::IdOf(manifest);
    EXPECT_TRUE(storage::AppendSession(store_, id, "{\"of\": " + std::to_string(payloads) + "}", manifest, {5}));
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < payloads; ++i) all.push_back(i);
    EXPECT_TRUE(storage::AppendHeld(store_, id, all, {6}));
    EXPECT_TRUE(storage::CloseSession(store_, id, {}, {7}));
    return id;
  }
  // A centre that has every file already; of the sessions in `refused` it takes none.
  void StartCentre() {
    http::Options options;
    options.logins.of_token = [](const std::string&) -> Result<std::optional<http::Person>> {
      return http::Person{"harbour", Role::kViewer, "*"};
    };
    options.answer_site = [this](const http::SiteRequest& request) -> Result<std::string> {
      RIGCAL_ASSIGN(const std::string body, request.read(static_cast<std::size_t>(request.body_bytes)));
      const std::lock_guard lock(mutex_);
      if (request.method == "GET" && request.path == lost_) {
        lost_.clear();
        return Fail(ErrorCode::kNotFound, "not all of it is here", "Send it.");
      }
      if (request.method == "GET") return formats::WriteForwardReceipt({true});
      if (request.path == never_whole_) return formats::WriteForwardReceipt({});
      if (request.path == refused_) return Fail(ErrorCode::kInvalidInput, "a robot of nobody", "Look.");
      if (!request.path.empty()) taken_.push_back(request.path + " " + body);
      if (!request.query.empty()) told_of_.push_back(request.path + "?" + request.query);
      return formats::WriteForwardReceipt({true});
    };
    auto server = http::Server::Start(
        options, [](const std::string&, const std::string&) -> Result<http::Page> { return http::Page{}; });
    ASSERT_TRUE(server);
    centre_.emplace(std::move(*server));
  }
  Forwarder StartForwarder() {
    const CentreAddress address{"http://127.0.0.1:" + std::to_string(centre_->port()), "token", ""};
    return std::move(Forwarder::Start({place(), &SystemClock(), address}).value());
  }
  std::vector<std::string> Taken() {
    const std::lock_guard lock(mutex_);
    return taken_;
  }
  template <typename IsSo>
  void Await(const IsSo& is_so) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!is_so(storage::LoadForwardState(store_).value().value()))
      ASSERT_LT(std::chrono::steady_clock::now(), until);
  }
  static std::string PathOf(const SessionId& session) { return "/sessions/" + session.str(); }

  std::mutex mutex_;
  std::vector<std::string> taken_, told_of_;
  std::string refused_, lost_, never_whole_;
  std::optional<http::Server> centre_;
};

TEST_F(ForwarderTest, SendsWhatWasBeforeAndWhatComes) {
  StartCentre();
  const SessionId before = CloseSession(2);
  Forwarder forwarder = StartForwarder();
  Await([](const ForwardState& state) { return state.sessions_waiting == 0; });
  const SessionId after = CloseSession(3);
  forwarder.Wake();
  Await([](const ForwardState& state) { return state.sessions_waiting == 0; });
  EXPECT_EQ(Taken(), (std::vector{PathOf(before) + " {\"of\": 2}", PathOf(after) + " {\"of\": 3}"}));
}

TEST_F(ForwarderTest, ARefusedSessionHoldsUpNoOther) {
  StartCentre();
  const SessionId first = CloseSession(2), second = CloseSession(3);
  refused_ = PathOf(first);
  const Forwarder forwarder = StartForwarder();
  Await([](const ForwardState& state) { return state.sessions_waiting == 1 && state.refused == 1; });
  EXPECT_EQ(Taken(), (std::vector{PathOf(second) + " {\"of\": 3}"}));
  EXPECT_NE(storage::LoadForwardState(store_)->value().last_error.find("a robot of nobody"), std::string::npos);
}

TEST_F(ForwarderTest, ASessionThatIsSentLateSaysWhatSupersedesIt) {
  StartCentre();
  const SessionId first = CloseSession(2), second = CloseSession(3);
  const Forwarder forwarder = StartForwarder();
  Await([](const ForwardState& state) { return state.sessions_waiting == 0; });
  const std::lock_guard lock(mutex_);
  EXPECT_EQ(told_of_, std::vector{PathOf(first) + "?superseded_by=" + second.str()});
}

TEST_F(ForwarderTest, ASessionThatNeverIsWholeThereHoldsUpNoOther) {
  StartCentre();
  const SessionId first = CloseSession(2), second = CloseSession(3);
  never_whole_ = PathOf(first);
  const Forwarder forwarder = StartForwarder();
  Await([](const ForwardState& state) { return state.sessions_waiting == 1 && state.refused == 1; });
  EXPECT_EQ(Taken(), (std::vector{PathOf(second) + " {\"of\": 3}"}));
}

TEST_F(ForwarderTest, ARestoredCentreGetsAgainWhatItLost) {
  StartCentre();
  const SessionId first = CloseSession(2), second = CloseSession(3);
  {
    const Forwarder before = StartForwarder();
    Await([](const ForwardState& state) { return state.sessions_waiting == 0; });
  }
  taken_.clear();
  lost_ = PathOf(second);
  const SessionId third = CloseSession(4);
  const Forwarder after = StartForwarder();
  Await([](const ForwardState& state) { return state.sessions_waiting == 0; });
  EXPECT_EQ(Taken(), (std::vector{PathOf(third) + " {\"of\": 4}", PathOf(first) + " {\"of\": 2}",
                                  PathOf(second) + " {\"of\": 3}"}));
}

TEST_F(ForwarderTest, WithoutACentreNothingWaits) {
  ASSERT_TRUE(storage::SetCentre(store_, "https://before", {1}));
  CloseSession(2);
  ASSERT_TRUE(Forwarder::Start({place(), &SystemClock(), {}}));
  EXPECT_FALSE(storage::LoadForwardState(store_).value());
  EXPECT_FALSE(storage::LoadNextForward(store_, {10}).value());
}

}  // namespace
}  // namespace rigcal::sites
