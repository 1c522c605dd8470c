#include "client/companion/drawn.h"
#include "client/companion/placement_words.h"
#include "client/companion/standing.h"
#include "server/formats/json/json_values.h"

namespace rigcal::companion {
namespace {

using calib::placement::NextPlacement;
using formats::JsonWriter;

void WritePoints(JsonWriter& out, std::string_view key, const std::vector<Eigen::Vector2d>& points) {
  out.List(key, [&] {
    for (const Eigen::Vector2d& point : points)
      out.List([&] {
        out.Number(point.x());
        out.Number(point.y());
      });
  });
}

// The newest picture, and where its corners are.
void WritePicture(JsonWriter& out, const Standing& standing, const Sensor& sensor) {
  const auto pictures = standing.captured.pictures.find(sensor.id);
  if (pictures == standing.captured.pictures.end() || pictures->second.empty()) return out.Null("picture");
  for (auto newest = standing.captures.rbegin(); newest != standing.captures.rend(); ++newest) {
    const auto picture = pictures->second.find(*newest);
    if (picture == pictures->second.end()) continue;
    return out.Object("picture", [&] {
      out.Text("path", picture->second.path);
      out.Text("capture", newest->str());
      out.Integer("width_px", picture->second.width_px);
      out.Integer("height_px", picture->second.height_px);
      const check::TargetSeen* best = nullptr;
      for (const auto& [target, seen] : picture->second.seen)
        if (best == nullptr || (seen.view.found && !best->view.found)) best = &seen;
      out.Text("why_not", best == nullptr ? picture->second.why_not : best->view.why_not);
      WritePoints(out, "corners_px", best == nullptr ? std::vector<Eigen::Vector2d>() : best->view.corners_px);
    });
  }
  out.Null("picture");
}

void WriteLooks(JsonWriter& out, const check::CameraFound& found) {
  formats::WriteIds(out, "board_in", found.with_board);
  formats::WriteIds(out, "board_not_in", found.without_board);
  out.Object("coverage", [&] {
    out.Number("share_ratio", found.coverage.share_ratio);
    out.Integer("columns", found.coverage.columns);
    out.List("corners", [&] {
      for (const int corners : found.coverage.corners) out.Integer(corners);
    });
  });
  out.Object("tilts", [&] {
    for (std::size_t side = 0; side < check::kTiltSides.size(); ++side)
      out.Object(check::kTiltSides[side], [&] {
        out.Number("largest_rad", found.ring.largest_rad[side]);
        out.Integer("views", static_cast<std::int64_t>(found.ring.views[side]));
      });
  });
  if (!found.distances) return out.Null("board_widths_away");
  out.List("board_widths_away", [&] {
    out.Number(found.distances->near_widths);
    out.Number(found.distances->far_widths);
  });
}

void WriteSharpness(JsonWriter& out, const check::CameraFound& found) {
  if (found.edge_px)
    out.Number("edge_px", *found.edge_px);
  else
    out.Null("edge_px");
  out.List("blurred", [&] {
    for (const check::BlurredPicture& one : found.blurred) out.Text(one.capture.str());
  });
}

void WriteSigma(JsonWriter& out, const Standing& standing, const SensorId& sensor) {
  const auto planned = PlannedIndexOf(standing.so_far, sensor);
  const bool is_known =
      planned && (*planned == standing.so_far.rig.reference || standing.advice.poses[*planned].tied_by > 0);
  out.Flag("is_known", is_known);
  if (!is_known) return formats::WriteNoSigmas(out);
  const calib::placement::PoseSoFar& pose = standing.advice.poses[*planned];
  for (const auto& [key, first] : {std::pair("sigma_m", 0), std::pair("sigma_rad", 3)})
    out.List(key, [&] {
      for (int axis = first; axis < first + 3; ++axis) out.Number(pose.sigma[axis]);
    });
  out.Number("of_tolerance_ratio", pose.of_tolerance);
  out.Integer("tied_by_captures", pose.tied_by);
}

void WriteSensors(JsonWriter& out, const Standing& standing) {
  out.List("sensors", [&] {
    for (const Sensor& sensor : standing.captured.header.sensors)
      out.Object([&] {
        out.Text("id", sensor.id.str());
        out.Text("type", NameOf(sensor.kind));
        const auto files = standing.captured.files.find(sensor.id);
        const bool has_files = files != standing.captured.files.end();
        out.Integer("files", has_files ? static_cast<std::int64_t>(files->second.size()) : 0);
        formats::WriteIds(out, "missing", MissingOf(standing, sensor.id));
        if (sensor.kind != SensorKind::kCamera) return;
        const check::CameraFound& found = standing.captured.cameras.at(sensor.id).found;
        WritePicture(out, standing, sensor);
        WriteLooks(out, found);
        WriteSharpness(out, found);
        WriteSigma(out, standing, sensor.id);
      });
  });
}

void WriteStand(JsonWriter& out, const calib::placement::Stand& stand) {
  out.Number("right_rad", stand.right_rad);
  out.Number("up_rad", stand.up_rad);
  out.Number("distance_m", stand.distance_m);
  out.Number("tilt_right_rad", stand.tilt_right_rad);
  out.Number("tilt_up_rad", stand.tilt_up_rad);
  out.Number("turned_rad", stand.turned_rad);
}

void WriteNext(JsonWriter& out, const Standing& standing) {
  if (!standing.so_far.unplaced.empty() || !standing.advice.next) return out.Null("next");
  const calib::placement::PlannedRig& rig = standing.so_far.rig;
  const NextPlacement& next = *standing.advice.next;
  out.Object("next", [&] {
    out.Text("camera", rig.cameras[next.camera].id.str());
    out.Text("board", rig.boards[next.board].id.str());
    WriteStand(out, next.stand);
    out.Text("of", rig.cameras[next.of].id.str());
    out.Text("axis", AxisText(next.axis));
    out.Number("sigma_now", next.sigma_now);
    out.Number("sigma_then", next.sigma_then);
    out.List("seen_by", [&] {
      for (const auto& look : next.capture.looks)
        out.Object([&] {
          out.Text("id", rig.cameras[look.camera].id.str());
          out.Integer("width_px", rig.cameras[look.camera].width_px);
          out.Integer("height_px", rig.cameras[look.camera].height_px);
          WritePoints(out, "outline_px",
                      OutlineInPicture(rig.cameras[look.camera], rig.boards[next.board], look.T_camera_board));
        });
    });
    const FromAbove above = DrawFromAbove(rig, next);
    out.Object("from_above", [&] {
      WritePoints(out, "board_m", above.board_m);
      out.List("cameras", [&] {
        for (const FromAbove::Camera& camera : above.cameras)
          out.Object([&] {
            out.Text("id", camera.id.str());
            WritePoints(out, "view_m", camera.view_m);
          });
      });
    });
  });
}

}  // namespace

std::string StandingJson(const Standing& standing) {
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("robot", standing.captured.header.robot.str());
    formats::WriteIds(out, "captures", standing.captures);
    out.Flag("looking", standing.captured.is_looking);
    out.Flag("enough", standing.is_enough);
    out.Text("headline", standing.headline);
    out.List("remarks", [&] {
      for (const std::string& remark : standing.remarks) out.Text(remark);
    });
    out.Object("limits", [&] {
      out.Number("tolerance_m", kDefaultTolerance.m);
      out.Number("tolerance_rad", kDefaultTolerance.rad);
    });
    WriteSensors(out, standing);
    WriteNext(out, standing);
  });
}

}  // namespace rigcal::companion
