#include "server/formats/revision/session_estimate.h"

#include "server/formats/edges/camera_fit.h"
#include "server/formats/json/json_values.h"
#include "server/formats/revision/lens_misfit_fields.h"
#include "server/formats/revision/moved_fields.h"
#include "server/formats/revision/session_groups_fields.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kSensorsMax = 10'000, kLooksMax = 10'000'000, kBytesMax = 256u << 20;

// A list of objects, each with what write_row(row) puts into it.
template <typename Row, typename WriteRow>
void WriteRows(JsonWriter& out, const char* name, const std::vector<Row>& rows, const WriteRow& write_row) {
  out.List(name, [&] {
    for (const Row& row : rows) out.Object([&] { write_row(row); });
  });
}

// None where there is no such list: documents of before lack some of them.
template <typename Row>
std::vector<Row> ReadRows(const JsonField& root, const char* name, Row (*read_row)(const JsonField&)) {
  std::vector<Row> rows;
  if (const auto list = root.Find(name))
    for (const JsonField& item : list->Items(kSensorsMax)) rows.push_back(read_row(item));
  return rows;
}

void WriteSmallestMove(JsonWriter& out, const SmallestMove& move) {
  out.Object("smallest_move", [&] {
    out.Integer("captures", move.captures);
    out.Number("m", move.m);
    out.Number("rad", move.rad);
  });
}

void WritePoses(JsonWriter& out, const SessionEstimate& estimate) {
  WriteRows(out, "poses", estimate.poses, [&](const RefinedPose& pose) {
    WritePose(out, "T_ref_sensor", pose.T_ref_sensor);
    out.Number("dof", pose.dof);
    out.Text("sensor", pose.sensor.str());
    if (pose.smallest_move) WriteSmallestMove(out, *pose.smallest_move);
  });
}

// Only where there are any, as estimates of before.
void WriteLenses(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.lenses.empty()) return;
  WriteRows(out, "lenses", estimate.lenses, [&](const RefinedLens& lens) {
    out.Text("camera", lens.camera.str());
    WriteLowerTriangle(out, "covariance", lens.covariance);
    WriteLensMembers(out, lens.intrinsics);
  });
}

// Likewise.
void WriteByPairs(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.by_pairs.empty()) return;
  WriteRows(out, "by_pairs", estimate.by_pairs, [&](const SmallestMoveByPairs& one) {
    out.Text("sensor", one.sensor.str());
    WriteSmallestMove(out, one.move);
  });
}

void WriteHeldBack(JsonWriter& out, const SessionEstimate& estimate) {
  WriteRows(out, "held_back", estimate.held_back, [&](const HeldBackLook& look) {
    if (!look.against.empty()) out.Text("against", look.against.str());
    out.Text("capture", look.capture.str());
    out.Text("sensor", look.sensor.str());
    if (look.why != WhyHeldBack::kContradicts) out.Text("why", NameOf(look.why));
  });
}

void WriteSlants(JsonWriter& out, const SessionEstimate& estimate) {
  WriteRows(out, "slants", estimate.slants, [&](const SlantBias& slant) {
    out.Text("lidar", slant.lidar.str());
    out.Number("sigma_m", slant.sigma_m);
    out.Number("too_long_m", slant.too_long_m);
  });
}

SlantBias ReadSlant(const JsonField& field) {
  return {ReadId<SensorId>(field.At("lidar")), field.At("too_long_m").Number(), field.At("sigma_m").Number()};
}

void WriteBends(JsonWriter& out, const SessionEstimate& estimate) {
  WriteRows(out, "bends", estimate.bends, [&](const BoardBend& bend) {
    out.Text("board", bend.board.str());
    out.Number("height_m", bend.height_m);
    out.Flag("is_the_board", bend.is_the_board);
    WriteIds(out, "seen_by", bend.seen_by);
    out.Number("sigma_m", bend.sigma_m);
  });
}

BoardBend ReadBend(const JsonField& field) {
  BoardBend bend{ReadId<TargetId>(field.At("board")), field.At("height_m").Number(), field.At("sigma_m").Number()};
  if (const auto is_the_board = field.Find("is_the_board"))
    bend.is_the_board = is_the_board->Flag();      // documents of before have
  if (const auto seen_by = field.Find("seen_by"))  // neither
    bend.seen_by = ReadIds<SensorId>(*seen_by, kSensorsMax);
  return bend;
}

// Only where there are any, as below.
void WriteStretches(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.stretches.empty()) return;
  WriteRows(out, "stretches", estimate.stretches, [&](const PrintStretch& stretch) {
    out.Text("board", stretch.board.str());
    out.Integer("corners_across", stretch.corners_across);
    out.Integer("corners_along", stretch.corners_along);
    out.Number("longer_ratio", stretch.longer_ratio);
    WriteIds(out, "seen_by", stretch.seen_by);
    out.Number("sigma_ratio", stretch.sigma_ratio);
  });
}

PrintStretch ReadStretch(const JsonField& field) {
  PrintStretch stretch{ReadId<TargetId>(field.At("board")), field.At("longer_ratio").Number(),
                       field.At("sigma_ratio").Number()};
  stretch.corners_along = static_cast<int>(field.At("corners_along").Integer(0, kLooksMax));
  stretch.corners_across = static_cast<int>(field.At("corners_across").Integer(0, kLooksMax));
  stretch.seen_by = ReadIds<SensorId>(field.At("seen_by"), kSensorsMax);
  return stretch;
}

void WriteContradictedLenses(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.contradicted_lenses.empty()) return;
  WriteRows(out, "contradicted_lenses", estimate.contradicted_lenses, [&](const ContradictedLens& lens) {
    out.Text("camera", lens.camera.str());
    if (!lens.like.empty()) out.Text("like", lens.like.str());
    out.Number("shift_px", lens.shift_px);
    out.Number("shift_rad", lens.shift_rad);
  });
}

void WriteLookScatter(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.look_scatter.empty()) return;
  WriteRows(out, "look_scatter", estimate.look_scatter, [&](const LookScatter& one) {
    out.Text("camera", one.camera.str());
    out.Number("sigma_rad", one.sigma_rad);
  });
}

LookScatter ReadLookScatter(const JsonField& field) {
  return {ReadId<SensorId>(field.At("camera")), field.At("sigma_rad").Number()};
}

ContradictedLens ReadContradictedLens(const JsonField& field) {
  ContradictedLens lens{ReadId<SensorId>(field.At("camera")), field.At("shift_px").Number(),
                        field.At("shift_rad").Number()};
  if (const auto like = field.Find("like")) lens.like = ReadId<SensorId>(*like);
  return lens;
}

// Only where there are any: what was made before trackers told their paths keeps its bytes.
void WriteClocks(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.clocks.empty()) return;
  WriteRows(out, "clocks", estimate.clocks, [&](const TrackerClock& clock) {
    out.Integer("captures", clock.captures);
    out.Number("given_sigma_s", clock.given_sigma_s);
    out.Flag("known", clock.IsKnown());
    out.Number("late_s", clock.late_s);
    out.Number("sigma_s", clock.sigma_s);
    out.Text("tracker", clock.tracker.str());
  });
}

TrackerClock ReadClock(const JsonField& field) {
  return {ReadId<SensorId>(field.At("tracker")), field.At("late_s").Number(), field.At("sigma_s").Number(),
          field.At("given_sigma_s").Number(), static_cast<int>(field.At("captures").Integer(0, kLooksMax))};
}

// Only where there are any, as estimates of before.
void WriteLostSights(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.lost_sights.empty()) return;
  WriteRows(out, "lost_sights", estimate.lost_sights, [&](const LostSight& one) {
    out.Text("first_lost", one.first_lost.str());
    out.Text("last_seen", one.last_seen.str());
    out.Integer("lost", one.lost);
    out.Number("odds", one.odds);
    out.Integer("seen", one.seen);
    out.Text("sensor", one.sensor.str());
  });
}

LostSight ReadLostSight(const JsonField& field) {
  return {ReadId<SensorId>(field.At("sensor")),
          ReadId<CaptureId>(field.At("last_seen")),
          ReadId<CaptureId>(field.At("first_lost")),
          static_cast<int>(field.At("seen").Integer(0, kLooksMax)),
          static_cast<int>(field.At("lost").Integer(0, kLooksMax)),
          field.At("odds").Number()};
}

RefinedLens ReadLens(const JsonField& field) {
  RefinedLens lens{ReadId<SensorId>(field.At("camera")), ReadLensMembers(field),
                   ReadLowerTriangle(field.At("covariance"))};
  if (lens.covariance.rows() != static_cast<Eigen::Index>(4 + lens.intrinsics.distortion.size()))
    field.At("covariance").Refuse("must have a row for every value");
  return lens;
}

// Likewise.
void WriteContradicted(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.contradicted.empty()) return;
  WriteRows(out, "contradicted", estimate.contradicted, [&](const ContradictedPair& pair) {
    out.Text("a", pair.a.str());
    out.Text("b", pair.b.str());
    out.Number("odds", pair.odds);
    WriteVector(out, "off", pair.off);
  });
}

ContradictedPair ReadContradicted(const JsonField& field) {
  return {ReadId<SensorId>(field.At("a")), ReadId<SensorId>(field.At("b")), ReadVector(field.At("off")),
          field.At("odds").Number()};
}

SmallestMove ReadSmallestMove(const JsonField& field) {
  return {field.At("m").Number(), field.At("rad").Number(),
          static_cast<int>(field.At("captures").Integer(0, kLooksMax))};
}

SmallestMoveByPairs ReadByPairs(const JsonField& field) {
  return {ReadId<SensorId>(field.At("sensor")), ReadSmallestMove(field.At("smallest_move"))};
}

RefinedPose ReadRefinedPose(const JsonField& field) {
  RefinedPose pose{ReadId<SensorId>(field.At("sensor")), ReadPose(field.At("T_ref_sensor"), kUnitTolerance),
                   field.At("dof").Number(), std::nullopt};
  if (const auto move = field.Find("smallest_move")) pose.smallest_move = ReadSmallestMove(*move);
  return pose;
}

// Likewise.
void WriteLate(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.late.empty()) return;
  WriteRows(out, "late", estimate.late, [&](const LateContradiction& one) {
    out.Integer("captures", one.captures);
    out.Text("first", one.first.str());
    if (!one.or_board.empty()) out.Text("or_board", one.or_board.str());
    if (!one.or_sensor.empty()) out.Text("or_sensor", one.or_sensor.str());
    if (one.or_world) out.Flag("or_world", true);
    out.Text("sensor", one.sensor.str());
  });
}

LateContradiction ReadLate(const JsonField& field) {
  return {ReadId<SensorId>(field.At("sensor")),
          ReadId<CaptureId>(field.At("first")),
          static_cast<int>(field.At("captures").Integer(1, kLooksMax)),
          ReadOptionalId<SensorId>(field, "or_sensor"),
          ReadOptionalId<TargetId>(field, "or_board"),
          field.Find("or_world").has_value()};
}

void CheckRows(const JsonField& root, const SessionEstimate& estimate) {
  Eigen::Index rows = 0;
  for (const RefinedPose& pose : estimate.poses) rows += pose.sensor == estimate.reference ? 0 : 6;
  if (estimate.covariance.rows() != rows)
    root.At("covariance").Refuse("needs six rows per pose, none of the reference");
  if (estimate.common.rows() != 0 && estimate.common.rows() != rows)
    root.At("common").Refuse("needs the covariance's rows");
}

// Without session and islands.
void WriteFields(JsonWriter& out, const SessionEstimate& estimate) {
  WriteBends(out, estimate);
  WriteRows(out, "boards_moved", estimate.boards_moved,
            [&](const BoardMovedWithin& moved) { WriteBoardMoved(out, moved); });
  WriteByPairs(out, estimate);
  WriteClocks(out, estimate);
  WriteLowerTriangle(out, "common", estimate.common);
  WriteContradicted(out, estimate);
  WriteContradictedLenses(out, estimate);
  WriteLowerTriangle(out, "covariance", estimate.covariance);
  WriteGroups(out, estimate);
  WriteHeldBack(out, estimate);
  WriteLate(out, estimate);
  WriteLenses(out, estimate);
  WriteLookScatter(out, estimate);
  WriteLostSights(out, estimate);
  WriteMisfits(out, "misfits", estimate.misfits);
  WriteRows(out, "moved", estimate.moved, [&](const SensorMovedWithin& moved) { WriteMoved(out, moved); });
  WriteNoise(out, estimate);
  WritePoses(out, estimate);
  out.Text("reference", estimate.reference.str());
  WritePupilShifts(out, estimate.pupil_shifts);
  WriteSlants(out, estimate);
  WriteStretches(out, estimate);
  WriteDiagnoses(out, "why_not", estimate.why_not);
}

SessionEstimate ReadFields(const JsonField& root) {
  SessionEstimate estimate;
  estimate.reference = ReadId<SensorId>(root.At("reference"));
  estimate.why_not = ReadDiagnoses(root.At("why_not"));
  for (const JsonField& item : root.At("poses").Items(kSensorsMax)) estimate.poses.push_back(ReadRefinedPose(item));
  estimate.covariance = ReadLowerTriangle(root.At("covariance"));
  estimate.common = ReadLowerTriangle(root.At("common"));
  CheckRows(root, estimate);
  for (const JsonField& item : root.At("moved").Items(kSensorsMax)) estimate.moved.push_back(ReadMoved(item));
  for (const JsonField& item : root.At("held_back").Items(kLooksMax)) {
    estimate.held_back.push_back({ReadId<SensorId>(item.At("sensor")), ReadId<CaptureId>(item.At("capture")),
                                  ReadOptionalId<SensorId>(item, "against")});
    if (const auto why = item.Find("why"))  // documents of before have none
      estimate.held_back.back().why = ReadNamed(*why, WhyHeldBackOf, WhyHeldBack::kContradicts);
  }
  estimate.boards_moved = ReadRows(root, "boards_moved", ReadBoardMoved);
  estimate.by_pairs = ReadRows(root, "by_pairs", ReadByPairs);
  estimate.slants = ReadRows(root, "slants", ReadSlant);
  estimate.pupil_shifts = ReadRows(root, "pupil_shifts", ReadPupilShift);
  estimate.stretches = ReadRows(root, "stretches", ReadStretch);
  estimate.look_scatter = ReadRows(root, "look_scatter", ReadLookScatter);
  estimate.contradicted_lenses = ReadRows(root, "contradicted_lenses", ReadContradictedLens);
  estimate.bends = ReadRows(root, "bends", ReadBend);
  estimate.clocks = ReadRows(root, "clocks", ReadClock);
  estimate.late = ReadRows(root, "late", ReadLate);
  estimate.lenses = ReadRows(root, "lenses", ReadLens);
  estimate.lost_sights = ReadRows(root, "lost_sights", ReadLostSight);
  estimate.contradicted = ReadRows(root, "contradicted", ReadContradicted);
  ReadGroupsAndNoise(root, estimate);
  if (const auto misfits = root.Find("misfits")) estimate.misfits = ReadMisfits(*misfits);
  return estimate;
}

}  // namespace

std::string WriteSessionEstimate(const SessionEstimate& estimate) {
  return WriteObject([&](JsonWriter& out) {
    WriteFields(out, estimate);
    out.Text("session", estimate.session.str());
    if (!estimate.islands.empty())
      WriteRows(out, "islands", estimate.islands, [&](const SessionEstimate& island) { WriteFields(out, island); });
  });
}

Result<SessionEstimate> ReadSessionEstimate(std::string_view text) {
  RIGCAL_ASSIGN(
      JsonDocument document,
      JsonDocument::Parse(text, {"session estimate", "Run `rigcal doctor`: the store is damaged.", kBytesMax}));
  const JsonField root = document.Root();
  SessionEstimate estimate = ReadFields(root);
  estimate.session = ReadId<SessionId>(root.At("session"));
  estimate.islands = ReadRows(root, "islands", ReadFields);
  RIGCAL_TRY(document.status());
  return estimate;
}

}  // namespace rigcal::formats
