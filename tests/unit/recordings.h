// Real data for tests. Nobody needs it to build and to test: a test without its data skips and says what is missing.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <map>
#include <string>

namespace rigcal {

// A file or folder of the recordings, which lie beside the project or are not there.
inline std::filesystem::path Recording(const std::string& name) {
  return std::filesystem::path(RIGCAL_SOURCE_DIR) / ".." / "shared" / "data" / name;
}

// Thirteen pairs of 640 x 480 pictures of a board with 9 x 6 inner corners of 25 mm: of the recordings, or the same
// files of Debian's package opencv-doc.
inline const char* const kStereoPairs = "stereo_opencv";
inline const char* const kDebianPictures = "/usr/share/doc/opencv-doc/examples/data";

// {"left/01": file, ...}; empty where neither is here.
inline std::map<std::string, std::filesystem::path> StereoPairs() {
  std::map<std::string, std::filesystem::path> pictures;
  for (const std::filesystem::path& folder : {Recording(kStereoPairs), std::filesystem::path(kDebianPictures)}) {
    if (!pictures.empty() || !std::filesystem::is_directory(folder)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      for (const std::string side : {"left", "right"}) {
        const std::string name = entry.path().filename().string();  // left01.jpg; there are others beside them
        if (name.size() != side.size() + 6 || name.rfind(side, 0) != 0 || entry.path().extension() != ".jpg") continue;
        const std::string number = name.substr(side.size(), 2);
        if (std::isdigit(static_cast<unsigned char>(number[0])) != 0) pictures[side + "/" + number] = entry.path();
      }
  }
  return pictures;
}

}  // namespace rigcal

#define RIGCAL_SKIP_WITHOUT_RECORDING(name)              \
  if (!std::filesystem::exists(rigcal::Recording(name))) \
  GTEST_SKIP() << "no recording " << (name) << " in ../shared/data beside the project"

#define RIGCAL_SKIP_WITHOUT_STEREO_PAIRS()                                                                  \
  if (rigcal::StereoPairs().empty())                                                                        \
  GTEST_SKIP() << "no stereo pairs: neither " << rigcal::kDebianPictures                                    \
               << " (package opencv-doc; dpkg may be told to leave /usr/share/doc out) nor ../shared/data/" \
               << rigcal::kStereoPairs
