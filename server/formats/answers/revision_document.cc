#include <algorithm>
#include <climits>

#include "server/base/limits.h"
#include "server/formats/answers/answer_rows.h"
#include "server/formats/documents.h"
#include "server/formats/edges/edge_fields.h"
#include "server/formats/edges/edge_reference.h"
#include "server/formats/json/json_values.h"
#include "server/formats/revision/cause_fields.h"
#include "server/formats/revision/insight_fields.h"
#include "server/formats/revision/lens_misfit_fields.h"
#include "server/formats/revision/measured_part_fields.h"
#include "server/formats/revision/policy_fields.h"
#include "server/formats/revision/scatter_fields.h"
#include "server/formats/revision/suspects_fields.h"
#include "server/formats/revision/verdict_basis_fields.h"

namespace rigcal::formats {
namespace {

constexpr int kWithWholeEdges = 1, kWithReferences = 2;  // formats

// What the covariance would be if edges were independent; null where it is that.
void WriteAnalytic(JsonWriter& out, const SensorPose& pose) {
  if (!pose.known || !pose.by_jackknife) return out.Null("analytic");
  out.Object("analytic", [&] {
    WriteMatrix(out, "covariance", pose.covariance_analytic);
    WriteSigmas(out, pose.covariance_analytic);
  });
}

void WriteFused(JsonWriter& out, const SensorPose& pose) {
  if (!pose.fused) return;
  out.Object("fused", [&] {
    out.Object("by_pairs", [&] {
      WritePose(out, "T_ref_sensor", pose.fused->T_ref_sensor_by_pairs);
      WriteMatrix(out, "covariance", pose.fused->covariance_by_pairs);
    });
    WritePooledScatter(out, *pose.fused);
    out.Integer("sessions", pose.fused->sessions);
    WriteScatterTaken(out, *pose.fused);
    out.Number("visit_sigma_m", pose.fused->visit_sigma_m);
    out.Number("visit_sigma_rad", pose.fused->visit_sigma_rad);
    if (pose.fused->walk_m_per_sqrt_day > 0) out.Number("walk_m_per_sqrt_day", pose.fused->walk_m_per_sqrt_day);
    if (pose.fused->walk_rad_per_sqrt_day > 0) out.Number("walk_rad_per_sqrt_day", pose.fused->walk_rad_per_sqrt_day);
  });
}

std::optional<FusedPose> ReadFused(const JsonField& pose) {
  const auto field = pose.Find("fused");
  if (!field) return std::nullopt;
  const JsonField by_pairs = field->At("by_pairs");
  FusedPose fused{ReadPose(by_pairs.At("T_ref_sensor"), kUnitTolerance), ReadMatrix(by_pairs.At("covariance")),
                  static_cast<int>(field->At("sessions").Integer(0, INT_MAX)), field->At("visit_sigma_m").Number(),
                  field->At("visit_sigma_rad").Number()};
  ReadScatter(*field, fused);
  if (const auto walk = field->Find("walk_m_per_sqrt_day")) fused.walk_m_per_sqrt_day = walk->Number();
  if (const auto walk = field->Find("walk_rad_per_sqrt_day")) fused.walk_rad_per_sqrt_day = walk->Number();
  return fused;
}

// Only where there are any: revisions of robots whose trackers tell no path keep their bytes.
void WriteClocks(JsonWriter& out, const FusedSessions& fused) {
  if (fused.clocks.empty()) return;
  out.List("clocks", [&] {
    for (const FusedSessions::ClockOfSession& told : fused.clocks)
      out.Object([&] {
        const TrackerClock& clock = told.clock;
        out.Integer("captures", clock.captures);
        out.Number("given_sigma_s", clock.given_sigma_s);
        out.Flag("known", clock.IsKnown());
        out.Number("late_s", clock.late_s);
        out.Text("session", told.session.str());
        out.Number("sigma_s", clock.sigma_s);
        out.Text("tracker", clock.tracker.str());
      });
  });
}

FusedSessions::ClockOfSession ReadClockOfSession(const JsonField& field) {
  return {ReadId<SessionId>(field.At("session")),
          {ReadId<SensorId>(field.At("tracker")), field.At("late_s").Number(), field.At("sigma_s").Number(),
           field.At("given_sigma_s").Number(), static_cast<int>(field.At("captures").Integer(0, INT_MAX))}};
}

// Likewise, of estimates of before.
void WriteInfluential(JsonWriter& out, const FusedSessions& fused) {
  if (!fused.influential) return;
  out.Object("influential", [&] {
    WriteIds(out, "captures", fused.influential->captures);
    out.Text("sensor", fused.influential->sensor.str());
    out.Text("session", fused.influential->session.str());
    out.Number("sigmas", fused.influential->sigmas);
  });
}

std::optional<FusedSessions::Influential> ReadInfluential(const JsonField& fused) {
  const auto field = fused.Find("influential");
  if (!field) return std::nullopt;
  return FusedSessions::Influential{ReadId<SessionId>(field->At("session")),
                                    ReadIds<CaptureId>(field->At("captures"), limits::kEdgesPerBatchMax),
                                    ReadId<SensorId>(field->At("sensor")), field->At("sigmas").Number()};
}

void WriteFusedSessions(JsonWriter& out, const FusedSessions& fused) {
  if (fused.sessions.empty()) return;
  out.Object("fused", [&] {
    WriteClocks(out, fused);
    WriteLowerTriangle(out, "covariance", fused.covariance);
    out.List("held_back", [&] {
      for (const FusedSessions::HeldBack& look : fused.held_back)
        out.Object([&] {
          if (!look.against.empty()) out.Text("against", look.against.str());
          out.Text("capture", look.capture.str());
          out.Text("sensor", look.sensor.str());
          out.Text("session", look.session.str());
          if (look.why != WhyHeldBack::kContradicts) out.Text("why", NameOf(look.why));
        });
    });
    WriteInfluential(out, fused);
    if (!fused.lenses.empty()) WriteMisfits(out, "lenses", fused.lenses);
    if (!fused.made_by.empty())
      out.List("made_by", [&] {
        for (const std::string& name : fused.made_by) out.Text(name);
      });
    if (fused.next_visit_days > 0) out.Number("next_visit_days", fused.next_visit_days);
    WriteIds(out, "sensors", fused.sensors);
    WriteIds(out, "sessions", fused.sessions);
  });
}

FusedSessions ReadFusedSessions(const JsonField& root) {
  FusedSessions fused;
  const auto field = root.Find("fused");
  if (!field) return fused;
  fused.covariance = ReadLowerTriangle(field->At("covariance"));
  fused.sensors = ReadIds<SensorId>(field->At("sensors"), limits::kSensorsPerRobotMax);
  fused.sessions = ReadIds<SessionId>(field->At("sessions"), limits::kEdgesPerBatchMax);
  for (const JsonField& look : field->At("held_back").Items(limits::kEdgesPerBatchMax)) {
    fused.held_back.push_back({ReadId<SessionId>(look.At("session")), ReadId<SensorId>(look.At("sensor")),
                               ReadId<CaptureId>(look.At("capture")), ReadOptionalId<SensorId>(look, "against")});
    if (const auto why = look.Find("why"))
      fused.held_back.back().why = ReadNamed(*why, WhyHeldBackOf, WhyHeldBack::kContradicts);
  }
  if (const auto clocks = field->Find("clocks"))
    for (const JsonField& clock : clocks->Items(limits::kSensorsPerRobotMax))
      fused.clocks.push_back(ReadClockOfSession(clock));
  fused.influential = ReadInfluential(*field);
  if (const auto days = field->Find("next_visit_days")) fused.next_visit_days = days->Number();
  if (const auto lenses = field->Find("lenses")) fused.lenses = ReadMisfits(*lenses);
  if (const auto made_by = field->Find("made_by"))
    for (const JsonField& name : made_by->Items(fused.sessions.size())) fused.made_by.push_back(name.Text());
  if (!fused.made_by.empty() && fused.made_by.size() != fused.sessions.size())
    field->At("made_by").Refuse("needs one name per session");
  if (fused.covariance.rows() != 6 * static_cast<Eigen::Index>(fused.sensors.size()))
    field->At("covariance").Refuse("needs six rows per sensor");
  return fused;
}

// What its sigmas are held against.
void WriteTolerance(JsonWriter& out, const SensorId& sensor, const std::optional<PolicyInForce>& policy) {
  if (!policy) return;
  const PoseLimit tolerance = LimitsOf(policy->policy, sensor).tolerance;
  out.Number("tolerance_m", tolerance.m);
  out.Number("tolerance_rad", tolerance.rad);
}

void WriteSensorPose(JsonWriter& out, const SensorPose& pose, const std::optional<PolicyInForce>& policy,
                     const std::optional<Eigen::Matrix3d>& R_ref_robot) {
  out.Object([&] {
    out.Text("id", pose.sensor.str());
    out.Flag("known", pose.known);
    WriteTolerance(out, pose.sensor, policy);
    if (pose.known) {
      WritePose(out, "T_ref_sensor", pose.T_ref_sensor);
      WriteMatrix(out, "covariance", pose.covariance);
      WriteSigmas(out, pose.covariance);
      out.Text("sigma_source", SigmaSourceOf(pose));
      if (pose.dof > 0 && (pose.by_jackknife || pose.fused)) out.Number("dof", pose.dof);
      WriteFused(out, pose);
    } else {
      for (const char* key : {"T_ref_sensor", "covariance", "sigma_source"}) out.Null(key);
      WriteNoSigmas(out);
      if (!pose.unobservable_basis.empty()) WriteOpenDirections(out, pose.unobservable_basis);
      WriteMeasuredPart(out, pose, R_ref_robot);
    }
    WriteAnalytic(out, pose);
  });
}

SensorPose ReadSensorPose(const JsonField& field) {
  SensorPose pose;
  pose.sensor = ReadId<SensorId>(field.At("id"));
  pose.known = field.At("known").Flag();
  if (const auto basis = field.Find("unobservable_basis"))
    for (const JsonField& direction : basis->Items(6)) pose.unobservable_basis.push_back(ReadVector(direction));
  if (!pose.known) {
    pose.measured_part = ReadMeasuredPart(field, pose.unobservable_basis);
    return pose;
  }
  pose.T_ref_sensor = ReadPose(field.At("T_ref_sensor"), kUnitTolerance);
  pose.covariance = ReadMatrix(field.At("covariance"));
  if (const auto dof = field.Find("dof")) pose.dof = dof->Number();
  pose.fused = ReadFused(field);
  if (const auto analytic = field.Find("analytic")) {
    pose.by_jackknife = true;
    pose.covariance_analytic = ReadMatrix(analytic->At("covariance"));
  }
  return pose;
}

// The document does not depend on the order in which edges are handed over.
std::vector<const Edge*> SortedById(const std::vector<Edge>& edges) {
  std::vector<const Edge*> sorted;
  sorted.reserve(edges.size());
  for (const Edge& edge : edges) sorted.push_back(&edge);
  std::sort(sorted.begin(), sorted.end(), [](const Edge* a, const Edge* b) { return a->id < b->id; });
  return sorted;
}

void WriteRevisionEdges(JsonWriter& out, const RevisionInput& input, int format) {
  std::vector<EdgeResidual> residuals = input.solution.residuals;
  std::sort(residuals.begin(), residuals.end(),
            [](const EdgeResidual& a, const EdgeResidual& b) { return a.edge < b.edge; });
  out.List("edges", [&] {
    for (const Edge* edge : SortedById(input.edges))
      out.Object([&] {
        format == kWithReferences ? WriteEdgeReference(out, *edge) : WriteEdgeSummary(out, *edge);
        if (format == kWithWholeEdges) WriteEdgeDetail(out, *edge);
        WriteResidual(out, ResidualOf(residuals, edge->id));
        WriteInfluence(out, input.solution.influences, edge->id);
      });
  });
}

void WriteSolution(JsonWriter& out, const RevisionInput& input) {
  const GraphSolution& solution = input.solution;
  out.Flag("converged", solution.converged);
  out.Integer("iterations", solution.iterations);
  out.Number("cost", solution.cost);
  out.Integer("dof", solution.dof);
  WriteGlobalErrors(out, solution.before, solution.after);
  WriteDiagnoses(out, "diagnoses", solution.diagnoses);
  out.List("sensors", [&] {
    for (const SensorPose& pose : solution.poses) WriteSensorPose(out, pose, input.policy, solution.R_ref_robot);
  });
  const auto in_part = [](const SensorPose& pose) { return pose.measured_part.has_value(); };
  if (std::any_of(solution.poses.begin(), solution.poses.end(), in_part)) WriteRobotAxes(out, solution.R_ref_robot);
  WriteSuspects(out, "suspects", solution.suspects);
  WriteInfluenceState(out, "influence", solution.influences);
  WriteCycles(out, "cycles", solution.cycles);
  WriteFusedSessions(out, solution.fused);
}

EdgeResidual ReadResidual(const JsonField& field, const EdgeId& edge) {
  EdgeResidual residual;
  residual.edge = edge;
  residual.in_solution = field.At("in_solution").Flag();
  residual.e = ReadVector(field.At("e"));
  residual.weighted = field.At("weighted").Number();
  const auto jackknife = field.Find("jackknife");
  if (!jackknife) return residual;
  residual.by_jackknife = true;
  residual.t_squared = jackknife->At("t_squared").Number();
  residual.rank = static_cast<int>(jackknife->At("rank").Integer(0, 6));
  residual.dof = jackknife->At("dof").Number();
  return residual;
}

GraphSolution ReadSolution(const JsonField& root) {
  GraphSolution solution;
  solution.converged = root.At("converged").Flag();
  solution.iterations = static_cast<int>(root.At("iterations").Integer(0, INT_MAX));
  solution.cost = root.At("cost").Number();
  solution.dof = static_cast<int>(root.At("dof").Integer(INT_MIN, INT_MAX));
  solution.before = ReadGlobalError(root.At("e_global").At("before"));
  solution.after = ReadGlobalError(root.At("e_global").At("after"));
  solution.diagnoses = ReadDiagnoses(root.At("diagnoses"));
  for (const JsonField& sensor : root.At("sensors").Items(limits::kSensorsPerRobotMax))
    solution.poses.push_back(ReadSensorPose(sensor));
  if (const auto axes = root.Find("robot_axes")) solution.R_ref_robot = ReadRobotAxes(*axes);
  if (const auto suspects = root.Find("suspects")) solution.suspects = ReadSuspects(*suspects);
  if (const auto influence = root.Find("influence")) solution.influences = ReadInfluenceState(*influence);
  if (const auto cycles = root.Find("cycles")) solution.cycles = ReadCycles(*cycles);
  solution.fused = ReadFusedSessions(root);
  return solution;
}

std::vector<RetiredSensor> ReadRetiredSensors(const JsonField& root) {
  std::vector<RetiredSensor> retired;
  const auto field = root.Find("retired_sensors");
  if (!field) return retired;
  for (const JsonField& gone : field->Items(limits::kSensorsPerRobotMax))
    retired.push_back({ReadId<SensorId>(gone.At("sensor")),
                       {ReadStamp(gone.At("at")), gone.At("who").Text(), gone.At("reason").Text()}});
  return retired;
}

std::string WriteInFormat(const RevisionInput& input, int format) {
  return WriteObject([&](JsonWriter& out) {
    out.Integer("format", format);
    out.Text("robot", input.robot.str());
    input.reference.empty() ? out.Null("reference") : out.Text("reference", input.reference.str());
    WriteVerdict(out, "verdict", input.verdict);
    WriteVerdictBasis(out, input.basis);
    WriteCauses(out, input.causes);
    if (!input.retired.empty()) WriteRetiredSensors(out, input.retired);
    if (input.policy) out.Object("policy", [&] { WritePolicyMembers(out, *input.policy); });
    WriteSolution(out, input);
    WriteRevisionEdges(out, input, format);
  });
}

void ReadRevisionEdges(const JsonField& edges, RevisionInput& input) {
  for (const JsonField& field : edges.Items(limits::kEdgesPerBatchMax)) {
    input.edges.push_back(input.whole ? ReadEdgeFields(field) : ReadEdgeReference(field, input.robot));
    if (const auto residual = field.Find("residual"))
      input.solution.residuals.push_back(ReadResidual(*residual, input.edges.back().id));
    if (const auto influence = field.Find("influence"))
      input.solution.influences.edges.push_back(ReadInfluence(*influence, input.edges.back().id));
  }
}

}  // namespace

std::string WriteRevisionDocument(const RevisionInput& input) { return WriteInFormat(input, kWithReferences); }

std::string WriteWholeRevisionDocument(const RevisionInput& input) { return WriteInFormat(input, kWithWholeEdges); }

Result<RevisionInput> ReadRevisionDocument(std::string_view text) {
  const JsonKind kind = {"revision", "Ask for the revision again; docs/api.md describes the document.",
                         limits::kRevisionBytesMax};
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, kind));
  const JsonField root = document.Root();
  RevisionInput input;
  input.whole = root.At("format").Integer(kWithWholeEdges, kWithReferences) == kWithWholeEdges;
  input.robot = ReadId<RobotId>(root.At("robot"));
  if (const auto reference = root.Find("reference")) input.reference = ReadId<SensorId>(*reference);
  input.verdict = ReadVerdict(root.At("verdict"));
  input.basis = ReadVerdictBasis(root);
  input.causes = ReadCauses(root);
  input.retired = ReadRetiredSensors(root);
  if (const auto policy = root.Find("policy")) input.policy = ReadPolicyMembers(*policy);
  input.solution = ReadSolution(root);
  ReadRevisionEdges(root.At("edges"), input);
  RIGCAL_TRY(document.status());
  return input;
}

}  // namespace rigcal::formats
