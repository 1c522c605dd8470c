// What a technician should do before leaving the robot: the verdict.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/check/findings.h"

namespace rigcal::check {

enum class Urgency { kRough, kFew, kNoAnswer };  // a result less sure than wanted; few captures; no result at all

struct Advice {
  std::vector<std::string> of;  // sensors, or pairs as "left - right"
  std::string text;             // one line: what is wrong, and what to do
  Urgency urgency = Urgency::kFew;
  std::size_t captures_more = 0;  // 0: more captures are not the cure
  std::size_t files_lacking = 0;  // that are missing or cannot be read, where their being there is
};

struct Judgement {
  std::vector<Advice> advice;        // worst first; empty: the session will do
  std::vector<std::string> remarks;  // files that are missing, unreadable, alike, blurred: sentences
  std::size_t captures_more = 0;     // at the least, by the advice that wants most
  std::vector<SensorId> clouds_of;   // lidars whose clouds were only counted: boards in them were not looked for
  [[nodiscard]] bool IsEnough() const { return advice.empty(); }  // nothing more is asked
};
// Advice on sensors, then on pairs that these do not explain, alike ones grouped.
[[nodiscard]] Judgement JudgeFindings(const Findings& findings);
// "Enough.", "Enough, as far as was looked: ...", "Take 7 more captures.", "Take at least 7 more captures.", "Not
// enough yet."
[[nodiscard]] std::string Headline(const Judgement& judgement);

// file_advice.cc: files of a sensor in a pair that are missing or cannot be read.
[[nodiscard]] std::optional<Advice> FileAdvice(const Findings& findings, const SensorFiles& files);
// Whether the sensor has enough once the files are there that FileAdvice asks for.
[[nodiscard]] bool FilesWouldBeEnough(const Findings& findings, const SensorFiles& files);
// Likewise: of the pair in which the sensor lacks files as the server tells it (captures_wanted.h), the captures; else
// none.
[[nodiscard]] std::vector<CaptureId> CapturesLacking(const Findings& findings, const SensorFiles& files);
// Likewise: sensors recorded in turn with it (captures_wanted.h), in other passes or groups.
[[nodiscard]] std::vector<SensorId> InTurnWith(const Findings& findings, const SensorFiles& files);
// Likewise: of `captures` those that none of these recorded.
[[nodiscard]] std::vector<CaptureId> CapturesOfItsPasses(const Findings& findings, const SensorFiles& files,
                                                         std::vector<CaptureId> captures);
// Likewise: cameras all of whose boards no camera found in any picture.
[[nodiscard]] std::optional<Advice> UnfoundBoards(const Findings& findings);
// sensor_advice.cc: of each sensor that is in a pair. Whoever has advice here explains its pairs, too.
[[nodiscard]] std::vector<Advice> SensorAdvice(const Findings& findings);
// Likewise of one camera that sees its board often enough: its lens, its sharpness.
[[nodiscard]] std::vector<Advice> LensAdvice(const Findings& findings, const CameraFound& camera);
// pair_advice.cc: of pairs, but for what advice on one of the two sensors says already, and asks at least as much for.
[[nodiscard]] std::vector<Advice> PairAdvice(const Findings& findings, const std::vector<Advice>& of_sensors);
// Pairs of which nothing comes, or not all, while others may make up for it: sentences.
[[nodiscard]] std::vector<std::string> PairRemarks(const Findings& findings);
// remarks.cc: what should be known of the files, whether it matters or not.
[[nodiscard]] std::vector<std::string> RemarksOf(const Findings& findings);

}  // namespace rigcal::check
