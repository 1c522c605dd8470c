#include "server/report/sections/cloud_section.h"

#include "server/report/edges/tables.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

std::string ShareText(const ColouredLidar& lidar) {
  if (lidar.points == 0) return "no points";
  const double percent = 100.0 * static_cast<double>(lidar.covered) / static_cast<double>(lidar.points);
  return Count(lidar.points, "point", "points") + ", " + Fixed(percent, 0) + " % seen by " +
         Count(lidar.cameras, "camera", "cameras");
}

void AddView(Dictionary& row, const std::string& file, const std::string& name, const std::string& lidar) {
  Dictionary* view = row.AddSectionDictionary("VIEW");
  view->SetValue("FILE", file);
  view->SetValue("NAME", name);
  view->SetValue("ALT", "Coloured cloud of " + lidar + ", " + name);
}

void FillLidar(Dictionary& row, const ColouredLidar& lidar) {
  row.SetValue("LIDAR", lidar.lidar);
  row.SetValue("CAPTURE", lidar.capture);
  row.SetValue("SHARE", ShareText(lidar));
  row.SetValue("PLY", lidar.ply);
  AddView(row, lidar.front_png, "front", lidar.lidar);
  AddView(row, lidar.oblique_png, "oblique", lidar.lidar);
  AddView(row, lidar.top_png, "top", lidar.lidar);
}

void FillOverlay(Dictionary& row, const CameraOverlay& overlay) {
  row.SetValue("CAMERA", overlay.camera);
  row.SetValue("LIDAR", overlay.lidar);
  row.SetValue("CAPTURE", overlay.capture);
  row.SetValue("FILE", overlay.points_jpg);
  row.SetValue("PICTURE", overlay.picture_jpg);
  row.SetValue("POINTS", Count(overlay.points, "point", "points"));
  if (overlay.width_px <= 0 || overlay.height_px <= 0) return;
  Dictionary* size = row.AddSectionDictionary("SIZE");
  size->SetValue("WIDTH", std::to_string(overlay.width_px));
  size->SetValue("HEIGHT", std::to_string(overlay.height_px));
}

}  // namespace

void FillClouds(Dictionary& page, const CloudSection& section) {
  if (section.lidars.empty() && section.overlays.empty() && section.notes.empty()) return;
  Dictionary* clouds = page.AddSectionDictionary("CLOUDS_SECTION")->AddIncludeDictionary("CLOUDS");
  clouds->SetFilename("clouds.tpl");
  for (const ColouredLidar& lidar : section.lidars) FillLidar(*clouds->AddSectionDictionary("CLOUD"), lidar);
  if (!section.overlays.empty()) {
    Dictionary* overlays = clouds->AddSectionDictionary("OVERLAYS");
    for (const CameraOverlay& overlay : section.overlays)
      FillOverlay(*overlays->AddSectionDictionary("OVERLAY"), overlay);
  }
  for (const std::string& note : section.notes) ShowValue(*clouds, "CLOUD_NOTE", "TEXT", note);
}

}  // namespace rigcal::report
