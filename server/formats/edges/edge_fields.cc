#include "server/formats/edges/edge_fields.h"

#include <algorithm>
#include <climits>

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kBlocksMax = 100'000;
constexpr std::size_t kContributionsMax = 64, kShiftsMax = 64;
constexpr std::size_t kFiguresMax = 1'000;
constexpr std::size_t kCapturesMax = 100'000;
constexpr std::size_t kShortTextMax = 64;  // the wire's string<64>

void WriteEstimate(JsonWriter& out, const Edge& edge) {
  WritePose(out, "T_a_b", edge.T_a_b);
  WriteSigmas(out, edge.uncertainty);
  out.Integer("dof", edge.uncertainty.dof);
  out.Integer("rank", edge.uncertainty.rank);
  out.Text("source", NameOf(edge.uncertainty.source));
}

void WriteNoEstimate(JsonWriter& out) {
  for (const char* key : {"T_a_b", "dof", "rank", "source"}) out.Null(key);
  WriteNoSigmas(out);
}

void WriteRatio(JsonWriter& out, double ratio) {
  ratio > 0.0 ? out.Number("jackknife_ratio", ratio) : out.Null("jackknife_ratio");
}

void WriteUncertaintyDetail(JsonWriter& out, const Uncertainty& uncertainty) {
  WriteRatio(out, uncertainty.jackknife_ratio);
  WriteMatrix(out, "information", uncertainty.Omega);
  WriteMatrix(out, "covariance", uncertainty.covariance);
  out.List("unobservable_basis", [&] {
    for (Eigen::Index i = 0; i < uncertainty.unobservable_basis.cols(); ++i)
      out.List([&] {
        for (int axis = 0; axis < 6; ++axis) out.Number(uncertainty.unobservable_basis(axis, i));
      });
  });
}

void WriteShifts(JsonWriter& out, const std::vector<Vector6d>& shifts) {
  out.List("shifts", [&] {
    for (const Vector6d& shift : shifts)
      out.List([&] {
        for (const double value : shift) out.Number(value);
      });
  });
}

void WriteContributions(JsonWriter& out, const std::vector<Contribution>& contributions) {
  out.List("contributions", [&] {
    for (const Contribution& contribution : contributions)
      out.Object([&] {
        WriteMatrix(out, "covariance", contribution.covariance);
        out.Text("name", contribution.name);
        if (!contribution.shifts.empty()) WriteShifts(out, contribution.shifts);
      });
  });
}

void WriteCaptures(JsonWriter& out, const std::vector<CaptureResidual>& captures) {
  out.List("captures", [&] {
    for (const CaptureResidual& capture : captures)
      out.Object([&] {
        out.Text("capture", capture.capture.str());
        out.Text("note", capture.note);
        out.Number("rms", capture.rms);
        out.Flag("used", capture.used);
      });
  });
}

void WriteEvidence(JsonWriter& out, const std::vector<Evidence>& evidence) {
  out.List("evidence", [&] {
    for (const Evidence& picture : evidence)
      out.Object([&] {
        picture.capture.empty() ? out.Null("capture") : out.Text("capture", picture.capture.str());
        out.Text("digest", picture.digest.str());
        out.Text("sensor", picture.sensor.str());
        out.Text("suffix", picture.suffix);
        out.Text("title", picture.title);
      });
  });
}

EdgeState ReadState(const JsonField& field) {
  const std::string state = field.Text();
  if (state != "good" && state != "failed") field.Refuse("must be \"good\" or \"failed\"");
  return state == "good" ? EdgeState::kGood : EdgeState::kFailed;
}

Uncertainty ReadUncertainty(const JsonField& edge) {
  Uncertainty uncertainty;
  uncertainty.Omega = ReadMatrix(edge.At("information"));
  uncertainty.covariance = ReadMatrix(edge.At("covariance"));
  uncertainty.rank = static_cast<int>(edge.At("rank").Integer(0, 6));
  uncertainty.dof = static_cast<int>(edge.At("dof").Integer(0, INT_MAX));
  uncertainty.source = ReadSource(edge.At("source"));
  if (const auto ratio = edge.Find("jackknife_ratio")) uncertainty.jackknife_ratio = ReadRatio(*ratio);
  uncertainty.contributions = ReadContributions(edge.At("contributions"));
  const std::vector<JsonField> basis = edge.At("unobservable_basis").Items(6);
  uncertainty.unobservable_basis.resize(6, static_cast<Eigen::Index>(basis.size()));
  for (std::size_t i = 0; i < basis.size(); ++i)
    uncertainty.unobservable_basis.col(static_cast<Eigen::Index>(i)) = ReadVector(basis[i]);
  return uncertainty;
}

std::vector<CaptureResidual> ReadCaptures(const JsonField& field) {
  std::vector<CaptureResidual> captures;
  for (const JsonField& item : field.Items(kCapturesMax))
    captures.push_back({ReadId<CaptureId>(item.At("capture")), item.At("rms").Number(), item.At("used").Flag(),
                        item.At("note").Text()});
  return captures;
}

std::vector<Evidence> ReadEvidence(const JsonField& field) {
  std::vector<Evidence> evidence;
  for (const JsonField& item : field.Items(kCapturesMax)) {
    const auto capture = item.Find("capture");
    evidence.push_back({item.At("title").Text(), ReadId<SensorId>(item.At("sensor")),
                        capture ? ReadId<CaptureId>(*capture) : CaptureId(), ReadId<Digest>(item.At("digest")),
                        item.At("suffix").Text(kShortTextMax)});
  }
  return evidence;
}

}  // namespace

void WriteEdgeSummary(JsonWriter& out, const Edge& edge) { WriteEdgeRow(out, edge, edge.figures); }

void WriteEdgeRow(JsonWriter& out, const Edge& edge, const std::map<std::string, double>& figures) {
  out.Text("id", edge.id.str());
  out.Text("frame_a", edge.frame_a.str());
  out.Text("frame_b", edge.frame_b.str());
  out.Text("state", edge.state == EdgeState::kGood ? "good" : "failed");
  out.Text("method", edge.method);
  edge.session.empty() ? out.Null("session") : out.Text("session", edge.session.str());
  if (edge.measured_at) WriteStamp(out, "measured_at", edge.measured_at);
  out.Integer("epoch", edge.epoch);
  edge.state == EdgeState::kGood ? WriteEstimate(out, edge) : WriteNoEstimate(out);
  WriteDiagnoses(out, "diagnoses", edge.diagnoses);
  out.Object("figures", [&] {
    for (const auto& [name, value] : figures) out.Number(name, value);
  });
}

void WriteEdgeDetail(JsonWriter& out, const Edge& edge) {
  out.Text("robot", edge.robot.str());
  if (edge.state == EdgeState::kGood) {
    WriteUncertaintyDetail(out, edge.uncertainty);
  } else {
    for (const char* key : {"jackknife_ratio", "information", "covariance"}) out.Null(key);
    out.List("unobservable_basis", [] {});
  }
  WriteContributions(out, edge.uncertainty.contributions);
  WriteCaptures(out, edge.captures);
  WriteEvidence(out, edge.evidence);
}

void WriteBlocks(JsonWriter& out, const std::vector<BlockVector>& blocks) {
  out.List("blocks", [&] {
    for (const BlockVector& block : blocks)
      out.Object([&] {
        out.Text("block_id", block.block_id);
        WriteVector(out, "d", block.d);
      });
  });
}

void WriteResidual(JsonWriter& out, const EdgeResidual* residual) {
  if (residual == nullptr) return out.Null("residual");
  out.Object("residual", [&] {
    WriteVector(out, "e", residual->e);
    out.Flag("in_solution", residual->in_solution);
    out.Number("weighted", residual->weighted);
    if (!residual->by_jackknife) return;
    out.Object("jackknife", [&] {
      out.Number("t_squared", residual->t_squared);
      out.Integer("rank", residual->rank);
      out.Number("dof", residual->dof);
    });
  });
}

const EdgeResidual* ResidualOf(const std::vector<EdgeResidual>& residuals, const EdgeId& edge) {
  const auto at = std::lower_bound(residuals.begin(), residuals.end(), edge,
                                   [](const EdgeResidual& residual, const EdgeId& id) { return residual.edge < id; });
  return at != residuals.end() && at->edge == edge ? &*at : nullptr;
}

Edge ReadEdgeRow(const JsonField& field) {
  Edge edge;
  edge.id = ReadId<EdgeId>(field.At("id"));
  edge.frame_a = ReadId<SensorId>(field.At("frame_a"));
  edge.frame_b = ReadId<SensorId>(field.At("frame_b"));
  edge.state = ReadState(field.At("state"));
  edge.method = field.At("method").Text(kShortTextMax);
  if (const auto session = field.Find("session")) edge.session = ReadId<SessionId>(*session);
  if (const auto measured = field.Find("measured_at")) edge.measured_at = ReadStamp(*measured);
  edge.epoch = static_cast<int>(field.At("epoch").Integer(1, INT_MAX));
  edge.diagnoses = ReadDiagnoses(field.At("diagnoses"));
  for (const auto& [name, value] : field.At("figures").Members(kFiguresMax)) edge.figures[name] = value.Number();
  if (edge.state == EdgeState::kGood) edge.T_a_b = ReadPose(field.At("T_a_b"), kUnitTolerance);
  return edge;
}

Edge ReadEdgeFields(const JsonField& field) {
  Edge edge = ReadEdgeRow(field);
  edge.robot = ReadId<RobotId>(field.At("robot"));
  edge.captures = ReadCaptures(field.At("captures"));
  edge.evidence = ReadEvidence(field.At("evidence"));
  if (edge.state == EdgeState::kGood) edge.uncertainty = ReadUncertainty(field);
  return edge;
}

std::vector<BlockVector> ReadBlocks(const JsonField& field) {
  std::vector<BlockVector> blocks;
  for (const JsonField& item : field.Items(kBlocksMax))
    blocks.push_back({item.At("block_id").Text(kShortTextMax), ReadVector(item.At("d"))});
  return blocks;
}

std::vector<Contribution> ReadContributions(const JsonField& field) {
  std::vector<Contribution> contributions;
  for (const JsonField& item : field.Items(kContributionsMax)) {
    contributions.push_back({item.At("name").Text(kShortTextMax), ReadMatrix(item.At("covariance"))});
    if (const auto shifts = item.Find("shifts"))
      for (const JsonField& shift : shifts->Items(kShiftsMax)) contributions.back().shifts.push_back(ReadVector(shift));
  }
  return contributions;
}

UncertaintySource ReadSource(const JsonField& field) {
  return ReadNamed(field, UncertaintySourceOf, UncertaintySource::kAssumed);
}

double ReadRatio(const JsonField& field) {
  const double ratio = field.Number();
  if (!(ratio >= 0.0 && ratio <= 1.0)) field.Refuse("must be between 0 and 1");
  return ratio;
}

}  // namespace rigcal::formats
