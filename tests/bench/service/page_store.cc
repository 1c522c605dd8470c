// Stores for measuring pages.  `page_store render DIR`: a rig of 12 sensors, 59 edges of 40 captures with two pictures
// each; publishes it, then again with one more edge; prints the times as JSON.  `page_store fleet DIR COUNT [VISITS]`:
// robots. `page_store serve DIR`: pages alone, without DDS, until its input ends.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "server/formats/documents.h"
#include "server/http/server.h"
#include "server/model/robots/fleet_list.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/edges/camera_fits.h"
#include "server/pipeline/reports/publish.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/robots/summaries.h"
#include "storage/edges/edges.h"
#include "storage/files/blobs.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"
#include "tests/unit/graph/random.h"

namespace rigcal {
namespace {

constexpr int kCaptures = 40;
constexpr std::size_t kPictureBytes = 30'000;

std::string Name(const char* prefix, int number) {
  std::string digits = std::to_string(number);
  return prefix + std::string(digits.size() < 2 ? 1 : 0, '0') + digits;
}

// Content that nobody else has, of the size of a JPEG.
Digest AppendPicture(const storage::Store& store, int number) {
  std::string bytes = "picture " + std::to_string(number);
  bytes.resize(kPictureBytes, static_cast<char>('a' + number % 26));
  return storage::AppendBlob(store.BlobFolder(), bytes).value();
}

Edge EdgeFrom(const GraphEdge& measured, const RobotId& robot, int number) {
  Edge edge;
  edge.id = EdgeId(Sha256Of("edge " + robot.str() + std::to_string(number)).str());
  edge.robot = robot;
  edge.frame_a = SensorId("sensor_" + measured.frame_a.str());
  edge.frame_b = SensorId("sensor_" + measured.frame_b.str());
  edge.T_a_b = measured.T_a_b;
  edge.state = EdgeState::kGood;
  edge.method = "stereo";
  edge.uncertainty = FromInformation(measured.Omega, UncertaintySource::kJackknife, kCaptures - 1);
  edge.figures = {{"rms_px", 0.2}, {"fx_a_px", 640.0}, {"fy_a_px", 640.0}, {"cx_a_px", 640.0}, {"cy_a_px", 360.0}};
  return edge;
}

// 200 pictures serve all edges: what costs time is their number in the report.
void AddCaptures(Edge& edge, const std::vector<Digest>& pictures, int number, std::mt19937& random) {
  for (int i = 0; i < kCaptures; ++i) {
    const CaptureId capture(Name("c", i));
    edge.captures.push_back({capture, 0.2 + 0.001 * i, true, ""});
    edge.uncertainty.blocks.push_back({capture.str(), graph::RandomVector(random, 1e-4, 1e-4)});
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
      edge.evidence.push_back({sensor.str() + " / " + capture.str() + ": 54 corners", sensor, capture,
                               pictures[static_cast<std::size_t>(number * 7 + i * 2) % pictures.size()], "jpg"});
  }
}

// What a camera of 40 pictures with 54 corners each keeps.
CameraFit FitOf(const SensorId& camera, std::mt19937& random) {
  std::normal_distribution<double> noise_px(0.0, 0.2);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  CameraFit fit;
  fit.camera = camera;
  fit.width_px = 1280, fit.height_px = 720;
  fit.source = IntrinsicsSource::kEstimated;
  fit.intrinsics = {640.0, 640.0, 640.0, 360.0};
  fit.sigma.assign(9, 0.1);
  for (int i = 0; i < kCaptures; ++i) {
    ViewFit view{CaptureId(Name("c", i)), {}, {}, 1.0 + place(random), {place(random) - 0.5, place(random) - 0.5}};
    for (int corner = 0; corner < 54; ++corner) {
      view.uv_px.emplace_back(1280.0 * place(random), 720.0 * place(random));
      view.residual_px.emplace_back(noise_px(random), noise_px(random));
    }
    fit.views.push_back(std::move(view));
  }
  return fit;
}

double PublishSeconds(storage::Store& store, const RobotId& robot) {
  const Revision revision = pipeline::Revise(store, robot, SystemClock()).value();
  const auto start = std::chrono::steady_clock::now();
  (void)pipeline::Publish(store, {robot, revision.number}, SystemClock()).value();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int Render(const char* folder) {
  storage::Store store = storage::Store::Open(folder).value();
  const graph::RandomRig rig = graph::MakeRig(12, 59, 77, 0.001, 0.0005);
  std::mt19937 random(1);
  std::vector<Digest> pictures;
  for (int i = 0; i < 200; ++i) pictures.push_back(AppendPicture(store, i));
  const RobotId robot("mars");
  const auto append = [&](int first, int last) {
    return store.Write([&]() -> Status {
      for (int i = first; i < last; ++i) {
        Edge edge = EdgeFrom(rig.graph.edges[static_cast<std::size_t>(i)], robot, i);
        AddCaptures(edge, pictures, i, random);
        RIGCAL_TRY(pipeline::AppendFits(store, {FitOf(edge.frame_a, random), FitOf(edge.frame_b, random)}, edge));
        RIGCAL_TRY(storage::AppendEdge(store, edge, SystemClock().Now()));
      }
      return {};
    });
  };
  if (!append(0, 58)) return 1;
  (void)PublishSeconds(store, robot);  // so that the next one has a revision to be compared with
  if (!append(58, 59)) return 1;
  const double changed_s = PublishSeconds(store, robot);
  std::filesystem::remove_all(store.ReportFolder());
  const auto start = std::chrono::steady_clock::now();
  (void)pipeline::Publish(store, {robot, 2}, SystemClock()).value();
  const double whole_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("{\"whole_s\": %.4f, \"changed_s\": %.4f}\n", whole_s, changed_s);
  return 0;
}

// Three edges and a published revision of them, measured a number of weeks ago.
Status AppendVisit(storage::Store& store, const graph::RandomRig& rig, const RobotId& robot, int number, int visit,
                   int weeks_ago) {
  const Stamp now = SystemClock().Now();
  formats::RevisionInput input;
  input.robot = robot;
  for (int i = 0; i < 3; ++i) {
    input.edges.push_back(EdgeFrom(rig.graph.edges[static_cast<std::size_t>(i)], robot, 3 * visit + i));
    RIGCAL_TRY(storage::AppendEdge(store, input.edges.back(), now));
  }
  input.reference = input.edges.front().frame_a;
  Revision revision;
  revision.robot = robot;
  revision.created_at = now;
  revision.calibrated_at = Stamp{now.ns - weeks_ago * kWeek_ns};
  revision.verdict = {static_cast<VerdictLevel>(number % 4), "Sentence " + std::to_string(number) + " says why.", ""};
  revision.document = formats::WriteRevisionDocument(input);
  revision.digest = Sha256Of(revision.document);
  RIGCAL_ASSIGN(revision.edge_watermark, storage::LoadEdgeWatermark(store, robot));
  RIGCAL_ASSIGN(revision.standing_watermark, storage::LoadStandingWatermark(store, robot));
  RIGCAL_ASSIGN(const int added, storage::AppendRevision(store, revision));
  const Edge& worst = input.edges.front();
  RIGCAL_TRY(storage::AppendWorstEdge(store, {robot, added}, {worst.frame_a, worst.frame_b, 0.001 * number}));
  return storage::AppendPublication(store, {robot, added}, now);
}

Status AppendSmallRobot(storage::Store& store, const graph::RandomRig& rig, int number, int visits) {
  const RobotId robot(Name("robot-", number));
  RIGCAL_TRY(storage::AppendRobot(store, robot, SystemClock().Now()));
  for (int visit = 0; visit < visits; ++visit)
    RIGCAL_TRY(AppendVisit(store, rig, robot, number, visit, visits - 1 - visit));
  const std::filesystem::path report = store.ReportFolder() / robot.str() / std::to_string(visits);
  std::filesystem::create_directories(report);  // a server draws again what is missing
  std::ofstream(report / "index.html") << "<p>A report.</p>";
  return {};
}

// Few robots at a time: what is not committed takes as much of the disk again.
Status AppendFleet(storage::Store& store, int count, int visits) {
  constexpr int kAtOnce = 500;
  const graph::RandomRig rig = graph::MakeRig(12, 59, 77, 0.001, 0.0005);
  for (int first = 0; first < count; first += kAtOnce)
    RIGCAL_TRY(store.Write([&]() -> Status {
      for (int i = first; i < std::min(count, first + kAtOnce); ++i)
        RIGCAL_TRY(AppendSmallRobot(store, rig, i, visits));
      return {};
    }));
  return {};
}

int FillFleet(const char* folder, int count, int visits) {
  storage::Store store = storage::Store::Open(folder).value();
  const Status filled = AppendFleet(store, count, visits);
  if (!filled) std::fprintf(stderr, "%s\n", filled.error().what.c_str());
  pipeline::RefreshAllSummaries(store, SystemClock());  // as a server that lived through it
  return filled ? 0 : 1;
}

int Serve(const char* folder) {
  pipeline::RevisionCache revisions;
  const auto answer = [&](const std::string& path, const std::string& query) -> Result<http::Page> {
    thread_local Result<storage::Store> store = storage::Store::Open(folder);
    if (!store) return Fail(store.error());
    RIGCAL_ASSIGN(auto page, pipeline::AnswerPage({*store, SystemClock(), revisions, {}, ""}, path, query));
    return http::Page{std::move(page.body), std::move(page.content_type), {}, page.immutable};
  };
  http::Options options;
  options.folder = std::filesystem::path(folder) / "reports";
  const auto server = http::Server::Start(options, answer);
  if (!server) return 1;
  std::printf("ready http://127.0.0.1:%d\n", server->port());
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
  return 0;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  const std::string mode = argc > 2 ? argv[1] : "";
  if (mode == "render") return rigcal::Render(argv[2]);
  if (mode == "fleet" && argc > 3)
    return rigcal::FillFleet(argv[2], std::atoi(argv[3]), argc > 4 ? std::atoi(argv[4]) : 1);
  if (mode == "serve") return rigcal::Serve(argv[2]);
  std::fprintf(stderr, "usage: page_store render DIR | page_store fleet DIR COUNT [VISITS] | page_store serve DIR\n");
  return 2;
}
