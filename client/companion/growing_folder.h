// A session folder that somebody still fills: what came since the last look, one file at a time.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/companion/captured.h"

namespace rigcal::companion {

// Reads and never writes; of one thread. Holds what it saw of every picture, never a picture's pixels beyond one.
// A file that is not whole yet, or is another, is looked at again once its size or a time of it changes.
class GrowingFolder {
 public:
  // Nothing is read yet; the folder need not be there.
  explicit GrowingFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Lists the folder again. True: files came, changed or went, or session.yaml did. kNotFound and what
  // formats::ReadSessionYaml refuses: there is no session (yet); what was seen before is kept until there is.
  [[nodiscard]] Result<bool> List();
  // Files that wait to be looked at.
  [[nodiscard]] std::size_t Waiting() const { return waiting_.size(); }
  // Looks at the next of them, oldest capture first; none: does nothing.
  void LookAtNext();
  // All that was looked at so far, cameras and their lenses estimated anew where pictures came; needs a session.
  [[nodiscard]] Captured SoFar();

 private:
  struct Stamp {
    std::int64_t size_bytes = 0, written_ns = 0, changed_ns = 0;  // a copy may keep the time of writing
    std::uint64_t inode = 0;
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  struct Listing {
    std::map<std::string, Stamp> files;  // by path in the folder
    std::map<std::string, Payload> payloads;
    std::vector<std::string> refusals;
  };
  [[nodiscard]] static Stamp StampOf(const struct stat& found);
  [[nodiscard]] Result<bool> ReadHeader();
  [[nodiscard]] Listing ListSensors() const;
  void ListSensor(const Sensor& sensor, Listing& listing) const;
  void ForgetWhatWent(const Listing& listing);
  void StartAnew(SessionHeader header);

  std::filesystem::path folder_;
  Stamp header_stamp_;
  std::optional<SessionHeader> header_;
  Listing listing_;
  std::vector<std::string> waiting_;  // paths, the next one last
  Captured captured_;
  std::set<SensorId> changed_;  // cameras with pictures since SoFar()
  calib::CameraMemory lenses_;
};

}  // namespace rigcal::companion
