#include "client/check/report.h"
#include "server/formats/json/json_values.h"
#include "server/model/approval/policy.h"

namespace rigcal::check {
namespace {

using formats::JsonWriter;

void WriteTexts(JsonWriter& out, std::string_view key, const std::vector<std::string>& texts) {
  out.List(key, [&] {
    for (const std::string& text : texts) out.Text(text);
  });
}

void WriteOptional(JsonWriter& out, std::string_view key, const std::optional<double>& value) {
  if (value)
    out.Number(key, *value);
  else
    out.Null(key);
}

void WriteTroubles(JsonWriter& out, std::string_view key, const std::vector<FileTrouble>& troubles) {
  out.List(key, [&] {
    for (const FileTrouble& trouble : troubles)
      out.Object([&] {
        out.Text("path", trouble.path);
        out.Text("why", trouble.why);
      });
  });
}

std::string UrgencyName(Urgency urgency) {
  return urgency == Urgency::kNoAnswer ? "no_answer" : urgency == Urgency::kFew ? "few" : "rough";
}

void WriteAdvice(JsonWriter& out, const Judgement& judgement) {
  out.List("advice", [&] {
    for (const Advice& advice : judgement.advice)
      out.Object([&] {
        WriteTexts(out, "of", advice.of);
        out.Text("text", advice.text);
        out.Text("urgency", UrgencyName(advice.urgency));
        out.Integer("captures_more", static_cast<std::int64_t>(advice.captures_more));
      });
  });
}

// What a policy of the server's says is not known here.
void WriteLimits(JsonWriter& out) {
  out.Object("limits", [&] {
    out.Number("tolerance_m", kDefaultTolerance.m);
    out.Number("tolerance_rad", kDefaultTolerance.rad);
  });
}

void WriteSensors(JsonWriter& out, const Findings& findings) {
  out.List("sensors", [&] {
    for (const SensorFiles& files : findings.sensors)
      out.Object([&] {
        out.Text("id", files.sensor.str());
        out.Text("type", rigcal::NameOf(files.kind));
        out.Integer("files", static_cast<std::int64_t>(files.files));
        out.Integer("usable", static_cast<std::int64_t>(files.usable));
        formats::WriteIds(out, "captures", files.present);
        WriteTroubles(out, "unreadable", files.unreadable);
      });
  });
}

void WriteRing(JsonWriter& out, const TiltRing& ring) {
  out.Object("tilts", [&] {
    for (std::size_t side = 0; side < kTiltSides.size(); ++side)
      out.Object(kTiltSides[side], [&] {
        out.Number("largest_rad", ring.largest_rad[side]);
        out.Integer("pictures", static_cast<std::int64_t>(ring.views[side]));
      });
  });
}

void WriteCoverage(JsonWriter& out, const Coverage& coverage) {
  out.Number("covered_ratio", coverage.share_ratio);
  out.Object("margin_ratio", [&] {
    for (std::size_t side = 0; side < kSidesOfPicture.size(); ++side)
      out.Number(kSidesOfPicture[side], coverage.margin_ratio[side]);
  });
}

void WriteCamera(JsonWriter& out, const CameraFound& camera) {
  out.Text("id", camera.camera.str());
  formats::WriteIds(out, "board_in", camera.with_board);
  formats::WriteIds(out, "board_not_in", camera.without_board);
  out.Integer("corners", static_cast<std::int64_t>(camera.corners));
  WriteCoverage(out, camera.coverage);
  WriteRing(out, camera.ring);
  const auto& away = camera.distances;
  WriteOptional(out, "nearest_widths", away ? std::optional(away->near_widths) : std::nullopt);
  WriteOptional(out, "farthest_widths", away ? std::optional(away->far_widths) : std::nullopt);
  WriteOptional(out, "edge_px", camera.edge_px);
  out.List("blurred", [&] {
    for (const BlurredPicture& picture : camera.blurred)
      out.Object([&] {
        out.Text("capture", picture.capture.str());
        out.Number("edge_px", picture.edge_px);
      });
  });
  formats::WriteIds(out, "resized", camera.resized);
  out.Text("lens", camera.estimates_lens ? "estimated" : "given");
  WriteOptional(out, "focal_sigma_ratio", camera.focal_sigma_ratio);
  std::vector<Diagnosis> problems;
  if (camera.lens_problem) problems.push_back(*camera.lens_problem);
  formats::WriteDiagnoses(out, "diagnoses", problems);
}

void WriteClouds(JsonWriter& out, const Findings& findings) {
  out.List("lidars", [&] {
    for (const LidarFound& lidar : findings.lidars)
      out.Object([&] {
        out.Text("id", lidar.lidar.str());
        out.Integer("clouds", static_cast<std::int64_t>(lidar.clouds));
        out.Integer("points_least", static_cast<std::int64_t>(lidar.points_least));
        out.Integer("points_most", static_cast<std::int64_t>(lidar.points_most));
        WriteTroubles(out, "odd", lidar.odd);
      });
  });
}

void WriteStreams(JsonWriter& out, const Findings& findings) {
  out.List("streams", [&] {
    for (const StreamFound& stream : findings.streams)
      out.Object([&] {
        out.Text("id", stream.stream.str());
        out.Integer("rows", static_cast<std::int64_t>(stream.rows));
        out.Number("duration_s", stream.seconds);
        out.Integer("gaps", static_cast<std::int64_t>(stream.gaps));
        out.Number("longest_gap_s", stream.longest_gap_s);
      });
  });
}

void WritePair(JsonWriter& out, const PairFound& pair) {
  const bool failed = pair.problem || (pair.edge && pair.edge->state == EdgeState::kFailed);
  out.Text("frame_a", pair.pair.a.str());
  out.Text("frame_b", pair.pair.b.str());
  out.Text("method", rigcal::NameOf(pair.method));
  out.Text("state", failed ? "failed" : pair.edge ? "good" : "counted");
  out.Integer("captures", static_cast<std::int64_t>(pair.both));
  out.Integer("captures_enough", static_cast<std::int64_t>(pair.needed.enough));
  if (pair.edge && !failed)
    formats::WriteSigmas(out, pair.edge->uncertainty);
  else
    formats::WriteNoSigmas(out);
  std::vector<Diagnosis> diagnoses;
  if (pair.edge) diagnoses = pair.edge->diagnoses;
  if (pair.problem) diagnoses.push_back(*pair.problem);
  formats::WriteDiagnoses(out, "diagnoses", diagnoses);
}

void WriteRefusals(JsonWriter& out, const Findings& findings) {
  out.List("refused", [&] {
    for (const Error& error : findings.refusals) out.Object([&] { formats::WriteErrorMembers(out, error); });
  });
}

}  // namespace

std::string ReportJson(const Findings& findings, const Judgement& judgement) {
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("robot", findings.robot.str());
    formats::WriteStamp(out, "captured_at", findings.captured_at);
    formats::WriteIds(out, "captures", findings.captures);
    out.Flag("enough", judgement.IsEnough() && findings.refusals.empty());
    out.Integer("captures_more", static_cast<std::int64_t>(judgement.captures_more));
    out.Text("verdict", Headline(judgement));
    formats::WriteIds(out, "clouds_not_looked_at", judgement.clouds_of);
    WriteLimits(out);
    WriteAdvice(out, judgement);
    WriteTexts(out, "remarks", judgement.remarks);
    WriteRefusals(out, findings);
    WriteSensors(out, findings);
    out.List("cameras", [&] {
      for (const auto& [id, camera] : findings.cameras) out.Object([&, &one = camera] { WriteCamera(out, one); });
    });
    WriteClouds(out, findings);
    WriteStreams(out, findings);
    out.List("pairs", [&] {
      for (const PairFound& pair : findings.pairs) out.Object([&] { WritePair(out, pair); });
    });
    out.List("same_files", [&] {
      for (const std::vector<std::string>& paths : findings.same_files)
        out.List([&] {
          for (const std::string& path : paths) out.Text(path);
        });
    });
  });
}

}  // namespace rigcal::check
