#include "server/report/edges/edge_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "server/formats/edges/camera_fit.h"
#include "server/model/edges/merged_edge.h"
#include "server/report/edges/bars.h"
#include "server/report/frame/retired_section.h"
#include "server/report/text/edge_axes.h"
#include "server/report/text/edge_state.h"
#include "server/report/text/figure_words.h"
#include "server/report/text/influence.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

void FillDiagnoses(Dictionary& section, const Edge& edge) {
  if (edge.diagnoses.empty()) return;
  Dictionary* diagnoses = section.AddSectionDictionary("DIAGNOSES");
  diagnoses->SetValue("LEVEL", HasFailed(edge) ? "fail" : "warn");
  for (const Diagnosis& diagnosis : edge.diagnoses) {
    Dictionary* one = diagnoses->AddSectionDictionary("DIAGNOSIS");
    one->SetValue("WHAT", diagnosis.what);
    one->SetValue("CURE", diagnosis.cure);
  }
}

bool IsMetric(const Edge& edge) { return ResidualUnitOf(edge.method) == "m"; }

// A closed fold says that something yellow is in it, and how bad its worst capture is.
void FillWarned(Dictionary& section, const Edge& edge) {
  const std::size_t warnings = WarningsOf(edge);
  if (warnings == 0) return;
  Dictionary* warned = section.AddSectionDictionary("WARNED");
  warned->SetValue("COUNT", Count(warnings, "warning", "warnings"));
  double worst = 0.0;
  for (const CaptureResidual& capture : edge.captures)
    if (capture.used) worst = std::max(worst, capture.rms);
  if (worst > 0)
    ShowValue(*warned, "WORST", "TEXT",
              Significant(worst * (IsMetric(edge) ? 1e3 : 1), 2) + (IsMetric(edge) ? " mm" : " px"));
}

void FillPose(Dictionary& section, const Edge& edge) {
  Dictionary* pose = section.AddSectionDictionary("POSE");
  pose->SetValue("FROM", edge.frame_a.str());
  pose->SetValue("TO", edge.frame_b.str());
  pose->SetValue("OBSERVABLE", ObservabilityText(edge));
  const RollPitchYaw angles = RollPitchYawOf(edge.T_a_b.q);
  const std::array<double, 3> rotation = {angles.roll, angles.pitch, angles.yaw};
  const std::array<const char*, 3> names = {"x, roll", "y, pitch", "z, yaw"};
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    Dictionary* row = pose->AddSectionDictionary("AXIS");
    row->SetValue("NAME", names[i]);
    row->SetValue("P", Mm(edge.T_a_b.p_m(axis)));
    row->SetValue("SP", AxisSigmaText(edge.uncertainty, axis));
    row->SetValue("R", Deg(rotation[i]));
    row->SetValue("SR", AxisSigmaText(edge.uncertainty, axis + tangent::kRotation));
  }
}

void FillRows(Dictionary& list, const std::vector<FigureRow>& rows) {
  for (const FigureRow& figure : rows) {
    Dictionary* row = list.AddSectionDictionary("FIGURE");
    row->SetValue("NAME", figure.name);
    row->SetValue("VALUE", figure.value);
  }
}

void FillFigures(Dictionary& section, const Edge& edge) {
  const FigureRows rows = RowsOf(edge);
  if (!rows.checks.empty()) FillRows(*section.AddSectionDictionary("FIGURES"), rows.checks);
  if (!rows.lens.empty()) FillRows(*section.AddSectionDictionary("LENS"), rows.lens);
}

void FillParts(Dictionary& section, const Edge& edge) {
  if (edge.uncertainty.contributions.empty()) return;
  Dictionary* parts = section.AddSectionDictionary("PARTS");
  for (const Contribution& contribution : edge.uncertainty.contributions) {
    const auto sigma = contribution.covariance.diagonal().cwiseMax(0.0).cwiseSqrt().eval();
    Dictionary* row = parts->AddSectionDictionary("PART");
    row->SetValue("NAME", contribution.name);
    row->SetValue("MM", SigmaMm(sigma.head<3>().maxCoeff()));
    row->SetValue("DEG", SigmaDeg(sigma.tail<3>().maxCoeff()));
  }
}

bool AnyUsed(const Edge& edge) {
  return std::any_of(edge.captures.begin(), edge.captures.end(), [](const auto& one) { return one.used; });
}

// One sentence where no capture was used, all for the same reason: the same line again and again says no more.
bool FillNoneUsed(Dictionary& notes, const Edge& edge) {
  const std::string& note = edge.captures.front().note;
  const bool same =
      std::all_of(edge.captures.begin(), edge.captures.end(), [&](const auto& one) { return one.note == note; });
  if (edge.captures.size() == 1 || AnyUsed(edge) || !same) return false;
  ShowValue(notes, "NONE_USED", "TEXT",
            "None of the " + std::to_string(edge.captures.size()) + " captures was used" +
                (note.empty() ? "" : ": " + note) + ".");
  return true;
}

// What a pair of a very large session left out is one sentence: nothing is to be learned of each.
void FillLeftOut(Dictionary& notes, const std::vector<CaptureResidual>& left_out) {
  if (left_out.empty()) return;
  ShowValue(notes, "LEFT_OUT", "TEXT",
            std::to_string(left_out.size()) + " captures are " + left_out.front().note + ".");
}

void FillUnused(Dictionary& notes, const Edge& edge) {
  constexpr std::size_t kUnusedMax = 30;
  if (FillNoneUsed(notes, edge)) return;
  std::vector<CaptureResidual> left_out;
  std::size_t shown = 0;
  for (const CaptureResidual& capture : edge.captures) {
    if (capture.note.starts_with(kLeftToRefinement)) left_out.push_back(capture);
    if (capture.used || capture.note.starts_with(kLeftToRefinement) || shown++ >= kUnusedMax) continue;
    Dictionary* row = notes.AddSectionDictionary("UNUSED");
    row->SetValue("CAPTURE", capture.capture.str());
    if (!capture.note.empty()) ShowValue(*row, "REASON", "NOTE", capture.note);
  }
  FillLeftOut(notes, left_out);
}

// Residuals as people read them: millimetres or pixels.
std::vector<CaptureResidual> Shown(const Edge& edge) {
  std::vector<CaptureResidual> captures = edge.captures;
  for (CaptureResidual& capture : captures) capture.rms *= IsMetric(edge) ? 1e3 : 1;
  return captures;
}

void FillCaptures(Dictionary& section, const Edge& edge) {
  if (edge.captures.empty()) return;
  Dictionary* notes = section.AddSectionDictionary("CAPTURE_NOTES");
  FillUnused(*notes, edge);
  if (!AnyUsed(edge)) return;  // axes without a bar
  Dictionary* captures = section.AddSectionDictionary("CAPTURES");
  const std::string unit = IsMetric(edge) ? "mm" : "px";
  captures->SetValue("UNIT", unit);
  const std::string cut = FillBars(*captures, Shown(edge), unit);
  if (!cut.empty()) ShowValue(*notes, "BARS_CUT", "TEXT", cut);
}

void FillInfluence(Dictionary& section, const ReportInput& input, const Edge& edge) {
  const auto blocks = input.blocks.find(edge.id);
  if (edge.state == EdgeState::kFailed || blocks == input.blocks.end()) return;
  const std::string text = InfluenceText(LargestInfluence(blocks->second, edge.uncertainty));
  if (!text.empty()) ShowValue(section, "INFLUENCE", "TEXT", text);
}

// The suffix becomes part of an address: only what we write ourselves.
bool IsPicture(const Evidence& evidence) { return evidence.suffix == "jpg" || evidence.suffix == "png"; }

// Of which captures somebody wants to see the pictures: left out, then the worst fits; what no residual tells of is
// last.
using WorthSeeing = std::pair<int, double>;
WorthSeeing WorthOf(const Edge& edge, const CaptureId& capture) {
  const auto found = std::find_if(edge.captures.begin(), edge.captures.end(),
                                  [&](const CaptureResidual& one) { return one.capture == capture; });
  if (found == edge.captures.end()) return {2, 0.0};
  return {found->used ? 1 : 0, std::isfinite(found->rms) ? -found->rms : 0.0};
}

// What is kept for the cameras' sections is none. Those of one capture stay together.
std::vector<const Evidence*> PicturesOf(const Edge& edge) {
  std::vector<std::pair<WorthSeeing, const Evidence*>> found;
  for (const Evidence& evidence : edge.evidence)
    if (evidence.suffix != formats::kCameraFitSuffix) found.emplace_back(WorthOf(edge, evidence.capture), &evidence);
  std::stable_sort(found.begin(), found.end(), [](const auto& x, const auto& y) {
    return std::tie(x.first, x.second->capture) < std::tie(y.first, y.second->capture);
  });
  std::vector<const Evidence*> pictures;
  for (const auto& [worth, evidence] : found) pictures.push_back(evidence);
  return pictures;
}

void FillPicture(Dictionary& picture, const Evidence& evidence, const std::set<Digest>& stored) {
  picture.SetValue("TITLE", evidence.title);
  if (!IsPicture(evidence) || stored.count(evidence.digest) == 0) return picture.ShowSection("MISSING");
  Dictionary* shown = picture.AddSectionDictionary("STORED");
  shown->SetValue("FILE", evidence.digest.str() + "." + evidence.suffix);
  if (evidence.title.empty()) shown->SetValue("TITLE", evidence.sensor.str() + " " + evidence.capture.str());
}

void FillPictures(Dictionary& section, const Edge& edge, const std::set<Digest>& stored, std::size_t pictures_max) {
  const std::vector<const Evidence*> all = PicturesOf(edge);
  if (all.empty()) return;
  Dictionary* pictures = section.AddSectionDictionary("PICTURES");
  const std::size_t count = std::min(all.size(), pictures_max);
  for (std::size_t i = 0; i < count; ++i) FillPicture(*pictures->AddSectionDictionary("PICTURE"), *all[i], stored);
  if (count == all.size()) return;
  Dictionary* more = pictures->AddSectionDictionary("MORE");
  more->SetValue("SHOWN", std::to_string(count));
  more->SetValue("COUNT", std::to_string(all.size()));
  if (!edge.session.empty()) ShowValue(*more, "SESSION", "ID", edge.session.str());
}

// People know a session by its time.
std::string ProvenanceOf(const ReportInput& input, const Edge& edge) {
  if (IsMergedOfSessions(edge)) return "Of this pair, what the sessions before the newest ones say together.";
  if (edge.figures.contains(kMergedPart))
    return "Earlier edges of this pair that contradict older ones, each pushed as a finished result, merged: what they "
           "say together.";
  if (IsMerged(edge))
    return "Earlier edges of this pair, each pushed as a finished result, merged: what they say together.";
  if (edge.session.empty())
    return edge.measured_at ? "Pushed as a finished result, measured " + TimeText(*edge.measured_at) + "."
                            : "Pushed as a finished result.";
  const auto facts = std::find_if(input.sessions.begin(), input.sessions.end(),
                                  [&](const SessionFacts& session) { return session.id == edge.session; });
  const std::string id = ShortDigest(edge.session.str());
  if (facts == input.sessions.end()) return "From session " + id + ".";
  return "From the session of " + TimeText(facts->captured_at) + ", " + id + ".";
}

}  // namespace

std::size_t WarningsOf(const Edge& edge) { return edge.state == EdgeState::kGood ? edge.diagnoses.size() : 0; }

void FillEdgeSection(Dictionary& section, const ReportInput& input, const ShownEdge& shown,
                     const std::set<Digest>& stored, std::size_t pictures_max, bool open) {
  const Edge& edge = *shown.edge;
  const bool failed = edge.state == EdgeState::kFailed;
  section.SetValue("STATE", StateWord(edge));
  section.SetValue("LEVEL", StateLevel(edge));
  section.SetValue("FROM", edge.frame_a.str());
  section.SetValue("TO", edge.frame_b.str());
  section.SetValue("METHOD", MethodText(edge));
  section.SetValue("ANCHOR", shown.anchor);
  section.SetValue("ID", edge.id.str());
  section.SetValue("PROVENANCE", ProvenanceOf(input, edge));
  if (open) section.ShowSection("OPEN");
  FillWarned(section, edge);
  if (HasWayOut(edge) && input.revision.edges.size() <= kWaysOutMax) FillRetire(section, RetireCommand(edge.id));
  FillDiagnoses(section, edge);
  if (!failed) FillPose(section, edge);
  FillFigures(section, edge);
  if (!failed) FillParts(section, edge);
  FillCaptures(section, edge);
  FillInfluence(section, input, edge);
  FillPictures(section, edge, stored, pictures_max);
}

}  // namespace rigcal::report
