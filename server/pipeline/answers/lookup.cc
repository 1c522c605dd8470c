#include "server/pipeline/answers/lookup.h"

#include <algorithm>
#include <set>

#include "server/formats/answers/answers.h"
#include "server/graph/fusion/merged_edge.h"
#include "server/graph/solve/solve.h"
#include "server/graph/uncertainty/joint_poses.h"
#include "server/graph/uncertainty/placed_poses.h"
#include "server/model/edges/past.h"
#include "server/pipeline/answers/names.h"
#include "server/pipeline/revisions/whole_revision.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/unknown_names.h"
#include "server/pipeline/robots/validity.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revision_poses.h"
#include "storage/revisions/revisions.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

bool ErrsAsNobodyKept(const MergedEdge& merged) {
  return merged.of_sessions && merged.by_blocks && merged.scores.cols() == 0;
}

// How the merged sessions of a revision err together is kept of the newest alone.
Status CheckScoresKept(storage::Store& store, const RobotId& robot, int number, const std::vector<MergedEdge>& merged) {
  if (std::none_of(merged.begin(), merged.end(), ErrsAsNobodyKept)) return {};
  RIGCAL_ASSIGN(const Revision newest, LoadRevisionSummaryOf(store, robot, 0));
  if (newest.number == number) return {};
  const std::string of = "revision " + std::to_string(number) + " of robot " + robot.str();
  return Fail(ErrorCode::kNotFound,
              "how surely these two sensors are known to each other was not kept with " + of +
                  ", and cannot be worked out since later revisions merged its older sessions",
              "Ask for the newest revision, or see the pose of each in the frame of the reference: `rigcal show " +
                  robot.str() + " --revision " + std::to_string(number) + "`.");
}

// Those of merged edges scatter as theirs do.
Result<graph::BlocksByEdge> BlocksOfWhole(storage::Store& store, formats::RevisionInput document, int number) {
  std::erase_if(document.edges, [](const Edge& edge) { return IsMerged(edge); });
  RIGCAL_ASSIGN(const auto merged, storage::LoadMergedEdges(store, document.robot, number));
  RIGCAL_TRY(CheckScoresKept(store, document.robot, number, merged));
  for (const MergedEdge& one : merged) document.edges.push_back(graph::EdgeOf(one, document.robot));
  return graph::BlocksOf(document.edges);
}

const SensorPose* FindPose(const GraphSolution& solution, const SensorId& sensor) {
  const auto pose = std::find_if(solution.poses.begin(), solution.poses.end(),
                                 [&](const SensorPose& one) { return one.sensor == sensor; });
  return pose == solution.poses.end() ? nullptr : &*pose;
}

// After "revision 3, which".
std::string StateWords(const Approval& approval, const Verdict& verdict) {
  switch (approval.state) {
    case RevisionState::kUnusable:
      return verdict.level == VerdictLevel::kFail ? "failed" : "is not verified";
    case RevisionState::kCandidate:
      return "nobody has approved";
    default:
      return "is " + WordFor(approval.state);
  }
}

// Of a sensor that the calibration in use lacks, which newer revision has it, and why that is not in use; nothing where
// none of the newest few has.
std::optional<Error> OnlyInNewer(const AnswerContext& context, const formats::LookupAnswer& asked,
                                 const SensorId& sensor) {
  constexpr int kLookedAtMax = 8;
  auto revision = context.revisions.Load(context.store, asked.robot, 0);
  for (int i = 0; i < kLookedAtMax && revision && revision->summary.number > asked.revision; ++i) {
    const int number = revision->summary.number;
    const GraphSolution& solution = revision->document->solution;
    if (const SensorPose* pose = FindPose(solution, sensor)) {
      const auto approval = LoadApproval(context.store, revision->summary);
      if (!approval) return approval.error();
      const SensorPose *a = FindPose(solution, asked.frame_a), *b = FindPose(solution, asked.frame_b);
      const std::string robot = asked.robot.str(), by_number = " --revision " + std::to_string(number) + "`";
      return Error{ErrorCode::kNotFound,
                   "sensor " + pose->sensor.str() + " is not in the calibration of " + robot +
                       " that is in use (revision " + std::to_string(asked.revision) + "), only in revision " +
                       std::to_string(number) + ", which " + StateWords(*approval, revision->summary.verdict),
                   a != nullptr && b != nullptr && a->known && b->known
                       ? "`rigcal lookup " + robot + " " + asked.frame_a.str() + " " + asked.frame_b.str() + by_number +
                             " gives it."
                       : "`rigcal show " + robot + by_number + " tells what is known of it."};
    }
    revision = context.revisions.Load(context.store, asked.robot, number - 1);
  }
  return std::nullopt;
}

Status CheckSensors(const RobotId& robot, const formats::RevisionInput& revision, const std::vector<SensorId>& asked) {
  std::vector<SensorId> known;
  for (const SensorPose& pose : revision.solution.poses) known.push_back(pose.sensor);
  for (const SensorId& sensor : asked) {
    if (std::find(known.begin(), known.end(), sensor) != known.end()) continue;
    const auto gone = std::find_if(revision.retired.begin(), revision.retired.end(),
                                   [&](const RetiredSensor& one) { return one.sensor == sensor; });
    if (gone == revision.retired.end()) return Fail(UnknownSensor(robot, sensor, known));
    return Fail(ErrorCode::kNotFound, RetiredText(*gone), BringsBack(RestoreCommand(robot, sensor)));
  }
  return {};
}

const SensorPose& PoseOf(const GraphSolution& solution, const SensorId& sensor) { return *FindPose(solution, sensor); }

bool HasJackknife(const SensorPose& pose) {
  return pose.by_jackknife || (pose.measured_part && pose.measured_part->by_jackknife);
}

// Good edges that took part when it was solved.
std::vector<Edge> EdgesInSolution(const formats::RevisionInput& document) {
  std::set<EdgeId> took_part;
  for (const EdgeResidual& residual : document.solution.residuals) took_part.insert(residual.edge);
  std::vector<Edge> edges = document.edges;
  std::erase_if(edges, [&](const Edge& edge) { return !took_part.contains(edge.id); });
  return edges;
}

// From the revision's own document and block vectors: of a revision from before its poses were kept, of very many
// sensors, and for the reason why one is not known. `told`: the document; it has both sensors.
Result<graph::RelativePose> DerivedRelative(const AnswerContext& context, int number,
                                            const formats::RevisionInput& told, const SensorId& a, const SensorId& b) {
  if (const auto fused = graph::RelativeOf(graph::FusedPosesOf(told.solution, told.reference), a, b)) return *fused;
  RIGCAL_ASSIGN(formats::RevisionInput document, WithWholeEdges(context.store, number, told, Blocks::kLoaded));
  if (!PoseOf(told.solution, a).known || !PoseOf(told.solution, b).known)
    document.solution = graph::WithPosesByPairs(std::move(document.solution));
  Graph graph = graph::GraphOf(EdgesInSolution(document), document.reference);
  graph.reference = document.reference;
  graph.sensors.clear();
  for (const SensorPose& pose : document.solution.poses) graph.sensors.push_back(pose.sensor);
  RIGCAL_ASSIGN(const graph::RelativePose analytic, graph::Relative(graph, document.solution, a, b));
  const auto& poses = document.solution.poses;
  graph::GraphJackknife jackknife;
  if (std::any_of(poses.begin(), poses.end(), HasJackknife)) {
    RIGCAL_ASSIGN(const graph::BlocksByEdge blocks, BlocksOfWhole(context.store, document, number));
    jackknife = graph::JackknifeGraph(graph, document.solution, blocks);
  }
  if (const auto relative = graph::RelativeOf(graph::JointPosesOf(graph, document.solution, jackknife), a, b))
    return *relative;
  return jackknife.available
             ? graph::RelativeByJackknife(jackknife, document.solution, a, b, analytic.unobservable_basis)
             : analytic;
}

// The robot's axes in the frame of a sensor; nothing where a turn of it was not measured.
std::optional<Eigen::Matrix3d> RobotAxesIn(const GraphSolution& solution, const SensorId& sensor) {
  const SensorPose& pose = PoseOf(solution, sensor);
  if (!solution.R_ref_robot || pose.Placed() == nullptr || !TurnsMeasured(AxesOf(pose, solution.R_ref_robot)))
    return std::nullopt;
  return Eigen::Matrix3d(pose.Placed()->R().transpose() * *solution.R_ref_robot);
}

// Of a sensor that has no pose as all that was measured of it is past, why that is, and what brings it back.
Status CheckNotPast(const formats::RevisionInput& told, const SensorId& sensor) {
  const Edge* past = nullptr;
  for (const Edge& edge : told.edges) {
    if (edge.frame_a != sensor && edge.frame_b != sensor) continue;
    if (!IsPast(edge)) return {};
    past = &edge;
  }
  if (past == nullptr || PoseOf(told.solution, sensor).known) return {};
  const Diagnosis& why = past->diagnoses.front();
  return Fail(ErrorCode::kNotFound,
              "of sensor " + sensor.str() + " nothing counts any more: " + past->frame_a.str() + " - " +
                  past->frame_b.str() + ": " + why.what,
              why.cure);
}

// As the revision kept it: what is known in part is as the graph of pairs has it, and the other pose is that of the
// same graph.
Result<graph::RelativePose> RelativeInPart(const AnswerContext& context, int number, const formats::RevisionInput& told,
                                           const SensorId& a, const SensorId& b) {
  if (!PoseOf(told.solution, a).known || !PoseOf(told.solution, b).known) {
    RIGCAL_ASSIGN(const auto placed, storage::LoadPlacedPoses(context.store, {told.robot, number}));
    if (const auto kept = placed ? graph::RelativeOf(*placed, a, b) : std::nullopt) return *kept;
  }
  return DerivedRelative(context, number, told, a, b);
}

// `by_number`: the revision was asked for.
Status TakeFromDocument(const AnswerContext& context, bool by_number, formats::LookupAnswer& answer) {
  RIGCAL_ASSIGN(const ParsedRevision revision, context.revisions.Load(context.store, answer.robot, answer.revision));
  const formats::RevisionInput& told = *revision.document;
  for (const SensorId& sensor : {answer.frame_a, answer.frame_b})
    if (!by_number && FindPose(told.solution, sensor) == nullptr)
      if (const auto newer = OnlyInNewer(context, answer, sensor)) return Fail(*newer);
  RIGCAL_TRY(CheckSensors(answer.robot, told, {answer.frame_a, answer.frame_b}));
  for (const SensorId& sensor : {answer.frame_a, answer.frame_b}) RIGCAL_TRY(CheckNotPast(told, sensor));
  RIGCAL_ASSIGN(const graph::RelativePose relative,
                RelativeInPart(context, answer.revision, told, answer.frame_a, answer.frame_b));
  answer.T_a_b = relative.T_A_B;
  answer.covariance = relative.covariance;
  answer.unobservable_basis = relative.unobservable_basis;
  answer.R_a_robot = RobotAxesIn(told.solution, answer.frame_a);
  return {};
}

// By its number, or that which robots are to use.
Result<Revision> RevisionToLookUp(const AnswerContext& context, const RobotId& robot, const Parameters& parameters) {
  if (!parameters.Text("revision")) return LoadRevisionInUse(context.store, robot);
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("revision", 0));
  return LoadRevisionSummaryOf(context.store, robot, number);
}

}  // namespace

Result<std::string> TellRelativePose(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const SensorId a, RequiredId<SensorId>(parameters, "a"));
  RIGCAL_ASSIGN(const SensorId b, RequiredId<SensorId>(parameters, "b"));
  RIGCAL_ASSIGN(const Revision revision, RevisionToLookUp(context, robot, parameters));
  RIGCAL_ASSIGN(const auto poses, storage::LoadRevisionPoses(context.store, {robot, revision.number}));
  formats::LookupAnswer answer;
  answer.robot = robot;
  answer.revision = revision.number;
  answer.frame_a = a;
  answer.frame_b = b;
  if (const auto kept = poses ? graph::RelativeOf(*poses, a, b) : std::nullopt) {
    answer.T_a_b = kept->T_A_B;
    answer.covariance = kept->covariance;
  } else {
    RIGCAL_TRY(TakeFromDocument(context, parameters.Text("revision").has_value(), answer));
  }
  answer.verdict = revision.verdict;
  RIGCAL_ASSIGN(answer.validity, LoadValidity(context.store, revision, context.clock.Now()));
  RIGCAL_ASSIGN(answer.approval, LoadApproval(context.store, revision));
  RIGCAL_ASSIGN(answer.runs, LoadWhatRuns(context.store, robot));
  return formats::WriteLookup(answer);
}

}  // namespace rigcal::pipeline
