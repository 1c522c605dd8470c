#include "server/formats/answers/answers.h"

#include <nlohmann/json.hpp>

#include "server/base/digests/sha256.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;

constexpr Stamp kNow{1769947200000000000};        // 2026-02-01T12:00:00Z
constexpr Stamp kDayBefore{1769860800000000000};  // 2026-01-31T12:00:00Z
const RobotId kRobot("mapper-01");
const Verdict kPass{VerdictLevel::kPass, "All is well.", "Nothing."};

const UsableRevision kUsable{3, kDayBefore};

RobotSummary SampleRobot() {
  RobotSummary robot{kRobot, 3, kPass, {kDayBefore, false, kUsable, true}, 2, 7, 1};
  robot.rig_model = "mars-mapper", robot.operator_name = "Ada";
  return robot;
}

SessionAnswer SampleSession() {
  return {SessionId(std::string(64, 'c')), kRobot, false, 18, 17, 1234567, kDayBefore, kNow, std::nullopt, "Ada", 1, 2};
}

TEST(Answers, Robots) {
  EXPECT_EQ(WriteRobots({SampleRobot()}, kNow),
            "{\"robots\":[{\"age_ns\":86400000000000,\"calculating\":true,\"calibrated_at\":\"2026-01-31T12:00:00Z\","
            "\"drive\":{\"kind\":\"ok\",\"rule\":\"OK to drive until 1 May 2026\",\"until\":\"2026-05-01T12:00:00Z\"},"
            "\"due\":{\"at\":\"2026-05-01T12:00:00Z\",\"by_age_at\":\"2026-05-01T12:00:00Z\",\"by_drift\":null,"
            "\"text\":\"due 1 May 2026 by age\"},"
            "\"edges\":7,\"given_up\":null,\"jobs_waiting\":1,\"operator\":\"Ada\",\"overdue\":false,\"revision\":3,"
            "\"rig_model\":\"mars-mapper\",\"robot\":\"mapper-01\",\"runs\":null,\"sessions\":2,\"site\":null,"
            "\"state\":\"unusable\","
            "\"status\":{\"next_step\":\"Nothing is to be done.\","
            "\"why\":\"It is within its tolerances; due 1 May 2026 by age.\",\"word\":\"ok\"},"
            "\"usable\":{\"calibrated_at\":null,\"created_at\":\"2026-01-31T12:00:00Z\",\"revision\":3,"
            "\"valid_until\":null},"
            "\"valid_until\":\"2026-05-01T12:00:00Z\",\"verdict\":{\"level\":\"pass\",\"what_to_do\":\"Nothing.\","
            "\"why\":\"All is well.\"}}]}");
  EXPECT_EQ(WriteRobots({}, kNow), "{\"robots\":[]}");
}

TEST(Answers, APartOfAListSaysWhereTheNextOneBegins) {
  const std::vector<RobotSummary> robots = {SampleRobot()};
  StatusAnswer status;
  status.robots = robots;
  for (const std::optional<RobotId>& next :
       {std::optional(kRobot), std::optional(RobotId()), std::optional<RobotId>()}) {
    status.next = next;
    for (const std::string& text :
         {WriteRobots(robots, kNow, next), WriteStatus(status, kNow), WriteDue(robots, 1, kNow, next)}) {
      const json document = json::parse(text);
      EXPECT_EQ(document.contains("next"), next.has_value()) << text;
      EXPECT_EQ(document.value("next", json()), next && !next->empty() ? json("mapper-01") : json()) << text;
    }
  }
}

TEST(Answers, Names) {
  EXPECT_EQ(WriteRobotNames({kRobot, RobotId("rover")}, true), R"({"more":true,"robots":["mapper-01","rover"]})");
  EXPECT_EQ(WriteSensorNames(kRobot, {SensorId("top")}, false),
            R"({"more":false,"robot":"mapper-01","sensors":["top"]})");
  EXPECT_EQ(WriteKnownRobot(RobotId("maper-01"), false, {kRobot}),
            R"({"known":false,"robot":"maper-01","slip_of":["mapper-01"]})");
  EXPECT_EQ(WriteKnownRobot(kRobot, true, {}), R"({"known":true,"robot":"mapper-01","slip_of":[]})");
}

TEST(Answers, ARobotWithoutRevisionHasNoAge) {
  const json row = json::parse(WriteRobots(
      {RobotSummary{kRobot, 0, {}, {std::nullopt, true, std::nullopt, false}, 0, 0, 0}}, kNow))["robots"][0];
  for (const char* key :
       {"revision", "calibrated_at", "age_ns", "valid_until", "usable", "site", "rig_model", "operator"})
    EXPECT_TRUE(row.at(key).is_null()) << key;
  EXPECT_EQ(row["verdict"]["level"], "unknown");
}

TEST(Answers, Sessions) {
  EXPECT_EQ(WriteSessions({SampleSession()}),
            "{\"sessions\":[{\"bytes\":1234567,\"captured_at\":\"2026-01-31T12:00:00Z\",\"closed_at\":null,"
            "\"jobs_total\":2,\"jobs_waiting\":1,\"opened_at\":\"2026-02-01T12:00:00Z\",\"operator\":\"Ada\","
            "\"payloads\":18,\"payloads_held\":17,\"retired\":null,\"robot\":\"mapper-01\",\"session\":\"" +
                std::string(64, 'c') +
                "\",\"standing\":null,\"state\":\"receiving\",\"superseded_by\":null,\"supersedes\":[]}]}");
}

TEST(Answers, ASupersededSessionSaysByWhich) {
  SessionAnswer session = SampleSession();
  session.standing = Standing{3, "pushed", {kNow, "robot mapper-01", ""}};
  session.superseded_by =
      Superseding{SessionId(std::string(64, 'd')), kDayBefore, "Eve", {4, "restored", {kNow, "Ada", "wrong squares"}}};
  session.supersedes = {SessionId(std::string(64, 'e'))};
  const json row = json::parse(WriteSessions({session}))["sessions"][0];
  EXPECT_EQ(row["standing"]["number"], 3);
  EXPECT_EQ(row["superseded_by"],
            json::parse("{\"session\":\"" + std::string(64, 'd') +
                        "\",\"captured_at\":\"2026-01-31T12:00:00Z\",\"operator\":\"Eve\","
                        "\"standing\":{\"number\":4,\"how\":\"restored\",\"at\":"
                        "\"2026-02-01T12:00:00Z\",\"who\":\"Ada\",\"reason\":\"wrong squares\"}}"));
  EXPECT_EQ(row["supersedes"], json::parse("[\"" + std::string(64, 'e') + "\"]"));
}

TEST(Answers, SessionHoldsManifestAndEdges) {
  const Manifest manifest = samples::SampleManifest();
  const json document = json::parse(WriteSession(SampleSession(), manifest, {samples::SampleEdge()}));
  EXPECT_EQ(document["session"]["state"], "receiving");
  EXPECT_EQ(document["manifest"], json::parse(WriteManifest(manifest)));
  EXPECT_EQ(document["edges"][0]["frame_b"], "right");
}

TEST(Answers, EdgesCarryTheirResidual) {
  const std::vector<Edge> edges = {samples::SampleFailedEdge(), samples::SampleEdge(), samples::SamplePlanarEdge()};
  Vector6d e = Vector6d::Zero();
  e(tangent::kRy) = 0.25;
  const json document = json::parse(WriteEdges(kRobot, 3, edges, {{edges[1].id, true, e, 0.5}}));
  EXPECT_EQ(document["revision"], 3);
  EXPECT_TRUE(document["edges"][0]["residual"].is_null());
  EXPECT_TRUE(document["edges"][2]["residual"].is_null());
  EXPECT_EQ(document["edges"][1]["residual"],
            json::parse(R"({"e":[0,0,0,0,0.25,0],"in_solution":true,"weighted":0.5})"));
  EXPECT_EQ(document["edges"][1]["sigma_m"][2], 3e-4);
  EXPECT_FALSE(document["edges"][1].contains("information"));
  EXPECT_TRUE(json::parse(WriteEdges(kRobot, 0, {}, {}))["revision"].is_null());
}

Revision SampleRevisionRow() {
  Revision revision;
  revision.robot = kRobot;
  revision.number = 3;
  revision.created_at = kDayBefore;
  revision.verdict = kPass;
  revision.document = WriteRevisionDocument(samples::SampleRevision());
  revision.digest = Sha256Of(revision.document);
  return revision;
}

TEST(Answers, ShowHoldsTheDocumentByteForByte) {
  const Revision revision = SampleRevisionRow();
  const std::string text = WriteShow(revision, true, {kDayBefore, true, kUsable, false}, kNow);
  EXPECT_NE(text.find(revision.document), std::string::npos);
  const json document = json::parse(text);
  EXPECT_EQ(document["age_ns"], 86400000000000);
  EXPECT_EQ(document["revision"], 3);
  EXPECT_EQ(document["published"], true);
  EXPECT_EQ(document["overdue"], true);
  EXPECT_EQ(document["valid_until"], "2026-05-01T12:00:00Z");
  EXPECT_EQ(document["drive"],
            (json{{"kind", "not_verified"},
                  {"rule", "Not verified: do not rely on it, overdue since 1 May 2026; capture again"},
                  {"until", nullptr}}));
  EXPECT_EQ(document["usable"]["revision"], 3);
  EXPECT_EQ(document["calculating"], false);
  EXPECT_EQ(Digest(document["digest"].get<std::string>()), Sha256Of(revision.document));
  EXPECT_EQ(document["document"]["reference"], "left");
}

TEST(Answers, Revisions) {
  const std::string text = WriteRevisions(kRobot, {SampleRevisionRow()}, kNow);
  const json row = json::parse(text)["revisions"][0];
  EXPECT_EQ(row["created_at"], "2026-01-31T12:00:00Z");
  EXPECT_EQ(row["verdict"]["level"], "pass");
  EXPECT_FALSE(row.contains("document"));
}

// Of a list in one piece there is no next page; of a page it is told, also that there is none.
TEST(Answers, PagesSayWhatTheNextOneIsAskedForWith) {
  EXPECT_FALSE(json::parse(WriteRevisions(kRobot, {}, kNow)).contains("next"));
  EXPECT_EQ(json::parse(WriteRevisions(kRobot, {}, kNow, 17))["next"], 17);
  EXPECT_TRUE(json::parse(WriteRevisions(kRobot, {}, kNow, 0)).at("next").is_null());
  EXPECT_FALSE(json::parse(WriteSessions({})).contains("next"));
  EXPECT_EQ(json::parse(WriteSessions({}, "ab"))["next"], "ab");
  EXPECT_TRUE(json::parse(WriteSessions({}, "")).at("next").is_null());
  EXPECT_FALSE(json::parse(WriteEdges(kRobot, 0, {}, {})).contains("next"));
  EXPECT_EQ(json::parse(WriteEdges(kRobot, 0, {}, {}, "cd"))["next"], "cd");
}

TEST(Answers, LookupHasTheVarianceOfOneAxisThere) {
  LookupAnswer answer;
  answer.robot = kRobot;
  answer.revision = 3;
  answer.frame_a = SensorId("left");
  answer.frame_b = SensorId("right");
  answer.T_a_b.p_m = {0.1, 0.2, 0.3};
  answer.covariance(tangent::kRx, tangent::kRx) = 4e-4;
  answer.verdict = {VerdictLevel::kUnknown, "Why.", "What.", "right"};
  const json document = json::parse(WriteLookup(answer));
  EXPECT_EQ(document["drive"]["rule"], "Not verified: do not rely on right");
  EXPECT_EQ(document["verdict"]["unverified"], "right");
  EXPECT_EQ(document["covariance"][3][3], 4e-4);
  EXPECT_EQ(document["covariance"][4][4], 0.0);
  EXPECT_EQ(document["sigma_rad"], json::parse("[0.02, 0.0, 0.0]"));
  EXPECT_EQ(document["sigma_m"], json::parse("[0.0, 0.0, 0.0]"));
  EXPECT_EQ(document["T_a_b"], json::parse(R"({"p_m":[0.1,0.2,0.3],"q_xyzw":[0.0,0.0,0.0,1.0]})"));
}

TEST(Answers, DueCountsFromTheLimit) {
  const std::int64_t day_ns = kNow.ns - kDayBefore.ns;
  const auto overdue = [&](std::optional<Stamp> at, std::int64_t max_age_ns) {
    RobotSummary robot = SampleRobot();
    robot.validity.calibrated_at = at;
    return json::parse(WriteDue({robot}, max_age_ns, kNow))["robots"][0]["overdue"].get<bool>();
  };
  EXPECT_FALSE(overdue(kDayBefore, day_ns));
  EXPECT_TRUE(overdue(kDayBefore, day_ns - 1));
  EXPECT_TRUE(overdue(std::nullopt, day_ns));
}

TEST(Answers, DueWithoutALimitGoesByThePolicyOfEachRobot) {
  RobotSummary robot = SampleRobot();
  for (const std::int64_t more_ns : {0, -1}) {
    robot.validity.max_age_ns = kNow.ns - kDayBefore.ns + more_ns;
    const json document = json::parse(WriteDue({robot}, std::nullopt, kNow));
    EXPECT_TRUE(document["max_age_ns"].is_null());
    EXPECT_EQ(document["robots"][0]["overdue"], more_ns < 0);
  }
}

TEST(Answers, Status) {
  StatusAnswer answer;
  answer.version = "0.1.0";
  answer.uptime_ns = 5;
  answer.jobs_waiting = 1;
  answer.robots = {SampleRobot()};
  const json status = json::parse(WriteStatus(answer, kNow));
  EXPECT_EQ(status["now"], "2026-02-01T12:00:00Z");
  EXPECT_EQ(status["version"], "0.1.0");
  EXPECT_EQ(status["uptime_ns"], 5);
  EXPECT_EQ(status["jobs_waiting"], 1);
  EXPECT_EQ(status["robots"][0]["sessions"], 2);
  EXPECT_TRUE(status["problem"].is_null());
  answer.problem = Error{ErrorCode::kStorage, "disk full", "Free some space."};
  EXPECT_EQ(json::parse(WriteStatus(answer, kNow))["problem"]["what"], "disk full");
  EXPECT_TRUE(status["open_batches"].empty());
  answer.open_batches = {{BatchId("b7"), kRobot, 59, 1, kDayBefore, kDayBefore}};
  const json batch = json::parse(WriteStatus(answer, kNow))["open_batches"][0];
  EXPECT_EQ(batch["batch"], "b7");
  EXPECT_EQ(batch["robot"], kRobot.str());
  EXPECT_EQ(batch["edges"], 59);
  EXPECT_EQ(batch["held"], 1);
  EXPECT_EQ(batch["opened_at"], "2026-01-31T12:00:00Z");
  EXPECT_EQ(batch["age_ns"], kNow.ns - kDayBefore.ns);
}

TEST(Answers, Health) {
  HealthAnswer answer;
  answer.version = "0.1.0";
  answer.disk_free_bytes = 1000;
  answer.schema = 2;
  answer.protocol = 1;
  answer.limits.open_sessions = 7;
  const json good = json::parse(WriteHealth(answer, kNow));
  EXPECT_EQ(good["state"], "ok");
  EXPECT_EQ(good["disk_free_bytes"], 1000);
  EXPECT_EQ(good["schema"], 2);
  EXPECT_EQ(good["protocol"], 1);
  EXPECT_EQ(good["limits"]["open_sessions"], 7);
  EXPECT_EQ(good["limits"].size(), limits::Settings().size());
  EXPECT_TRUE(good["problem"].is_null());
  EXPECT_EQ(good["lost_files"]["count"], 0);
  PartState disk{"disk", Error{ErrorCode::kStorage, "disk full", "Free some space."}, kNow, 3};
  answer.parts = {{"intake", {}, {}, 1}, disk};
  answer.lost_files = 2;
  answer.first_lost_files = {{RobotId("r"), SessionId("s"), "left/01.png", true}};
  const json bad = json::parse(WriteHealth(answer, kNow));
  EXPECT_EQ(bad["state"], "failing");
  EXPECT_EQ(bad["problem"]["code"], "storage");
  EXPECT_EQ(bad["parts"][0], json::parse(R"({"failures":1,"name":"intake","problem":null,"since":null})"));
  EXPECT_EQ(bad["parts"][1]["problem"]["what"], "disk full");
  EXPECT_EQ(bad["parts"][1]["since"], "2026-02-01T12:00:00Z");
  EXPECT_EQ(bad["lost_files"]["count"], 2);
  EXPECT_EQ(bad["lost_files"]["first"][0]["path"], "left/01.png");
  EXPECT_EQ(bad["lost_files"]["first"][0]["state"], "missing");
}

TEST(Answers, ErrorsComeBack) {
  const Error error{ErrorCode::kNotFound, "robot \"x\" is not known", "See `rigcal robots`."};
  const std::string text = WriteError(error);
  EXPECT_EQ(text,
            "{\"error\":{\"code\":\"not_found\",\"cure\":\"See `rigcal robots`.\",\"what\":\"robot \\\"x\\\" is not "
            "known\"}}");
  const auto read = ReadError(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->code, ErrorCode::kNotFound);
  EXPECT_EQ(read->what, error.what);
  EXPECT_FALSE(ReadError("{\"robots\":[]}"));
  EXPECT_FALSE(ReadError("{\"error\":3}"));
  EXPECT_FALSE(ReadError("{\"error\":"));
}

TEST(Events, HaveTheDocumentedMembers) {
  const json edge = json::parse(WriteEdgeEvent(samples::SampleEdge(), 1, 3));
  EXPECT_EQ(edge["edge"]["state"], "good");
  EXPECT_EQ(edge["jobs_total"], 3);
  const json graph = json::parse(WriteGraphEvent(kRobot, 3, samples::SampleRevision().solution));
  EXPECT_EQ(graph["sensors"], 3);
  EXPECT_EQ(graph["sensors_known"], 2);
  EXPECT_EQ(graph["e_global"]["after"]["total"], 0.03);
  const json revision = json::parse(WriteRevisionEvent(SampleRevisionRow(), kUsable));
  EXPECT_EQ(revision["verdict"]["level"], "pass");
  EXPECT_EQ(revision["usable"]["revision"], 3);
  EXPECT_TRUE(json::parse(WriteRevisionEvent(SampleRevisionRow(), std::nullopt))["usable"].is_null());
  EXPECT_EQ(json::parse(WriteSessionEvent(SampleSession()))["payloads_held"], 17);
  EXPECT_EQ(WritePublishedEvent(kRobot, 3, "/robots/mapper-01/revisions/3/"),
            "{\"path\":\"/robots/mapper-01/revisions/3/\",\"revision\":3,\"robot\":\"mapper-01\"}");
}

}  // namespace
}  // namespace rigcal::formats
