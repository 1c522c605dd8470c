// READ: where one sensor is in the frame of another, and how surely.
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// Verb lookup: T_a_b of the sensors `a` and `b` of `robot`, with its covariance in the right tangent at b (m, rad), as
// a revision says it: the one that robots are to use, or `revision`. An edge that arrived since plays no part. Along
// directions that were not measured the pose is held, and they are named. Both are as the revision kept them; of one
// that kept none they are derived from its document, or kNotFound says why not.
[[nodiscard]] Result<std::string> TellRelativePose(const AnswerContext& context, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
