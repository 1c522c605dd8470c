#include "client/check/capture_names.h"

#include <algorithm>
#include <set>

#include "client/check/words.h"
#include "server/calib/core/capture_blocks.h"

namespace rigcal::check {
namespace {

constexpr std::size_t kStretchMin = 3, kPartsMax = 6;

// A name or a stretch, and how many captures it is.
struct Part {
  std::string text;
  std::size_t captures = 0;
};

void AppendRun(const std::vector<CaptureId>& run, std::vector<Part>& parts) {
  if (run.size() >= kStretchMin) return parts.push_back({run.front().str() + " to " + run.back().str(), run.size()});
  for (const CaptureId& capture : run) parts.push_back({capture.str(), 1});
}

std::vector<Part> PartsOf(const std::vector<CaptureId>& some, const std::vector<CaptureId>& all) {
  const std::set<CaptureId> named(some.begin(), some.end());
  std::vector<Part> parts;
  std::vector<CaptureId> run;
  for (const CaptureId& capture : all) {
    if (named.contains(capture)) {
      run.push_back(capture);
      continue;
    }
    AppendRun(run, parts);
    run.clear();
  }
  AppendRun(run, parts);
  return parts;
}

}  // namespace

std::vector<CaptureId> InOrder(std::vector<CaptureId> captures) {
  std::sort(captures.begin(), captures.end(), calib::TakenBefore());
  captures.erase(std::unique(captures.begin(), captures.end()), captures.end());
  return captures;
}

std::string Stretches(const std::vector<CaptureId>& some, const std::vector<CaptureId>& all) {
  std::vector<Part> parts = PartsOf(some, all);
  if (parts.size() > kPartsMax) {
    std::size_t left = 0;
    for (std::size_t i = kPartsMax - 1; i < parts.size(); ++i) left += parts[i].captures;
    parts.resize(kPartsMax - 1);
    parts.push_back({std::to_string(left) + " more", left});
  }
  std::vector<std::string> texts;
  for (const Part& part : parts) texts.push_back(part.text);
  return Enumerated(texts);
}

std::string MissingText(const std::string& thing, const std::vector<CaptureId>& present,
                        const std::vector<CaptureId>& all) {
  const std::set<CaptureId> held(present.begin(), present.end());
  std::vector<CaptureId> missing;
  for (const CaptureId& capture : all)
    if (!held.contains(capture)) missing.push_back(capture);
  if (missing.empty()) return "";
  return thing + " for " + std::to_string(all.size() - missing.size()) + " of " + std::to_string(all.size()) +
         " captures: " + Stretches(missing, all) + (missing.size() == 1 ? " is missing" : " are missing");
}

}  // namespace rigcal::check
