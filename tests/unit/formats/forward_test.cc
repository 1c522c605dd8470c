// What a site and its centre tell each other comes back as it was.
#include "server/formats/sites/forward.h"

#include <gmock/gmock.h>

#include "server/base/digests/sha256.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using ::testing::HasSubstr;

Edge PushedEdge(samples::RandomValues& random) {
  Edge edge = samples::SampleEdge();
  edge.session = SessionId();
  edge.T_a_b = random.Pose();
  edge.measured_at = Stamp{1'700'000'000'123'456'789};
  edge.uncertainty = FromInformation(random.PositiveDefinite(), UncertaintySource::kJackknife, 1);
  edge.uncertainty.jackknife_ratio = 1.0 / 3.0;
  edge.uncertainty.blocks = {{"01", random.Vector()}, {"02", random.Vector()}};
  edge.uncertainty.contributions = {{"flatness", random.PositiveDefinite()}};
  edge.id = PushedEdgeId(edge.robot, ContentDigest(edge), 0);
  return edge;
}

TEST(EdgeSlice, KeepsWhatIdsAreMadeOf) {
  samples::RandomValues random;
  for (int i = 0; i < 50; ++i) {
    const Edge edge = PushedEdge(random);
    const Result<EdgeSlice> read = ReadEdgeSlice(WriteEdgeSlice({edge.robot, 9, {{7, edge}, {8, edge}}}));
    ASSERT_TRUE(read) << read.error().what;
    EXPECT_EQ(read->robot, edge.robot);
    EXPECT_EQ(read->count, 9);
    ASSERT_EQ(read->items.size(), 2u);
    EXPECT_EQ(read->items[0].first, 7);
    EXPECT_EQ(read->items[1].first, 8);
    EXPECT_EQ(PushedEdgeId(edge.robot, ContentDigest(read->items[0].second), 0), edge.id);
  }
}

TEST(EdgeSlice, RefusesWhatIsNone) {
  samples::RandomValues random;
  const Edge edge = PushedEdge(random);
  const std::string good = WriteEdgeSlice({edge.robot, 9, {{7, edge}}});
  EXPECT_FALSE(ReadEdgeSlice(good.substr(1)));
  EXPECT_FALSE(ReadEdgeSlice(WriteEdgeSlice({edge.robot, 9, {{9, edge}}}))) << "there are nine, from 0";
  Edge bad = edge;
  bad.frame_b = bad.frame_a;
  EXPECT_FALSE(ReadEdgeSlice(WriteEdgeSlice({edge.robot, 9, {{7, bad}}})));
}

TEST(ForwardReceipt, ComesBack) {
  const std::vector<Digest> missing = {Sha256Of("a"), Sha256Of("b")};
  const ForwardReceipt part = ReadForwardReceipt(WriteForwardReceipt({false, missing})).value();
  EXPECT_FALSE(part.is_whole);
  EXPECT_EQ(part.missing, missing);
  EXPECT_TRUE(ReadForwardReceipt(WriteForwardReceipt({true}))->is_whole);
  EXPECT_FALSE(ReadForwardReceipt("<html>"));
}

TEST(SupersededBy, ComesBack) {
  const std::vector<SessionId> by = {SessionId(Sha256Of("a").str()), SessionId(Sha256Of("b").str())};
  const std::string text = WriteSupersededBy(by);
  EXPECT_EQ(text, "?superseded_by=" + by[0].str() + "," + by[1].str());
  EXPECT_EQ(ReadSupersededBy(std::string_view(text).substr(1)).value(), by);
  EXPECT_EQ(WriteSupersededBy({}), "");
  EXPECT_TRUE(ReadSupersededBy("")->empty());
  EXPECT_TRUE(ReadSupersededBy("of_a_later_version=1")->empty());
  EXPECT_FALSE(ReadSupersededBy("superseded_by=mapper-01"));
}

TEST(WordsAtCentre, ComeBack) {
  const WordAtCentre one{RobotId("r"), Sha256Of("a"), Stamp{1'700'000'000'000'000'001}, "Ada", "\"checked\""};
  WordAtCentre no = one;
  no.how = "rejected";
  const auto words = ReadWordsAtCentre(WriteWordsAtCentre({{one, one}, {no}})).value();
  ASSERT_EQ(words.rejected.size(), 1u);
  EXPECT_EQ(words.rejected[0].how, "rejected");
  const auto& read = words.in_use;
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].robot, one.robot);
  EXPECT_EQ(read[0].digest, one.digest);
  EXPECT_EQ(read[0].at, one.at);
  EXPECT_EQ(read[0].who, "Ada");
  EXPECT_EQ(read[0].reason, "\"checked\"");
  EXPECT_EQ(read[0].how, "approved");
  const std::string of_before = R"({"in_use":[{"robot":"r","digest":")" + one.digest.str() +
                                R"(","at":"2026-01-31","who":"Ada","reason":"so"}]})";
  EXPECT_EQ(ReadWordsAtCentre(of_before)->in_use.at(0).how, "approved");
  const std::vector<RobotId> robots = {RobotId("b"), RobotId("a")};
  EXPECT_EQ(ReadRobotsAsked(WriteRobotsAsked(robots)).value(), robots);
  EXPECT_FALSE(ReadRobotsAsked("[]"));
}

TEST(ErrorDocument, OfAServerAndOfNone) {
  const Error read =
      ReadErrorDocument(R"({"error": {"code": "conflict", "what": "it is another's", "cure": "Look."}})");
  EXPECT_EQ(read.code, ErrorCode::kConflict);
  EXPECT_EQ(read.what, "it is another's");
  EXPECT_EQ(ReadErrorDocument("<html>Bad gateway</html>").code, ErrorCode::kUnreachable);
}

TEST(ForwardStateDocument, OfASiteAndOfNone) {
  EXPECT_EQ(WriteForwardState(std::nullopt),
            R"({"batches_waiting":0,"failing_since":null,"last_error":null,"oldest_at":null,"refused":0,)"
            R"("sessions_waiting":0,"url":null})");
  ForwardState state;
  state.url = "https://centre";
  state.sessions_waiting = 3;
  state.failing_since = Stamp{0};
  state.last_error = "no answer";
  EXPECT_THAT(WriteForwardState(state),
              HasSubstr(R"("failing_since":"1970-01-01T00:00:00Z","last_error":"no answer")"));
}

}  // namespace
}  // namespace rigcal::formats
