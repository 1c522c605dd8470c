#include "server/formats/rig_files/assumed_edges.h"
#include "server/formats/rig_files/urdf_patch.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

// Patched by what the file says itself nothing changes; moved, it is still a file.
void CheckPatch(std::string_view text, const std::map<std::string, Se3>& poses, const std::string& root) {
  for (const auto& [link, pose] : poses)
    if (!(pose.p_m.norm() < 1e5)) return;  // moved, it may be beyond what is taken
  rig_files::LinkPoses wanted{root, poses};
  const auto same = rig_files::PatchUrdf(text, "f", wanted);
  if (!fuzz::RequireGoodError(same)) return;
  for (auto& [link, pose] : wanted.poses) pose.p_m.x() += 0.5;
  const auto moved = rig_files::PatchUrdf(text, "f", wanted);
  if (!fuzz::RequireGoodError(moved)) return;
  fuzz::Require(rig_files::ReadRigFile(moved->text, "f").has_value(), "a patched robot can be read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::TextOf(data, size);
  const auto file = rig_files::ReadRigFile(text, "f");
  if (!fuzz::RequireGoodError(file)) return 0;
  const std::string root = file->poses.front().parent;
  const auto poses = rig_files::PosesIn(*file, root);
  if (!fuzz::RequireGoodError(poses)) return 0;
  for (const auto& [frame, pose] : *poses) fuzz::RequireFinite(pose.Matrix(), "pose");
  if (file->format == "urdf") CheckPatch(text, *poses, root);
  (void)fuzz::RequireGoodError(rig_files::AllFrames(*file));
  return 0;
}
