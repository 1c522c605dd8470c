#include "server/report/text/culprit.h"

#include <cctype>
#include <string>
#include <string_view>

namespace rigcal::report {
namespace {

bool IsOfName(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) || letter == '_' || letter == '-';
}

// Where `name` stands as a whole word; npos: nowhere.
std::size_t WholeWordAt(std::string_view name, std::string_view sentence) {
  std::size_t at = sentence.find(name);
  for (; at != std::string_view::npos; at = sentence.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if ((at == 0 || !IsOfName(sentence[at - 1])) && (end == sentence.size() || !IsOfName(sentence[end]))) break;
  }
  return at;
}

}  // namespace

std::optional<SensorId> CulpritOf(const formats::RevisionInput& revision) {
  if (revision.verdict.level == VerdictLevel::kPass) return std::nullopt;
  std::optional<SensorId> named;
  std::size_t first = std::string_view::npos;
  for (const SensorPose& pose : revision.solution.poses)
    if (const std::size_t at = WholeWordAt(pose.sensor.str(), revision.verdict.why); at < first) {
      first = at;
      named = pose.sensor;
    }
  return named;
}

}  // namespace rigcal::report
