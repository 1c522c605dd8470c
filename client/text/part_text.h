// Poses of which directions were not measured, for people. `told`: of docs/api.md a sensor of `show`, or a `lookup`.
#pragma once

#include <ostream>
#include <string>

#include "client/text/document.h"

namespace rigcal::client {

// Whether something, and not all, of the pose was measured.
[[nodiscard]] bool IsInPart(const Document& told);
// "height not measured", "one direction not measured"
[[nodiscard]] std::string OpenText(const Document& told);
// "The height of lidar was not measured; the rest is good to 0.41 mm and 0.012 deg."
[[nodiscard]] std::string PartSentence(const Document& told, const std::string& whose);
// Roll, pitch, yaw in degrees; "-" where a turn was not measured.
[[nodiscard]] std::string PartRpyText(const Document& told, int digits);
// Six lines: along or about what, where, and sigma or "not measured". `robot_axes`: of docs/api.md, in the frame of the
// pose.
void PrintPart(const Document& told, const Document& robot_axes, std::ostream& out);
// Of all sensors of a revision's document that are known in part: sentence and lines. Nothing where there is none.
void PrintParts(const Document& revision, std::ostream& out);

}  // namespace rigcal::client
