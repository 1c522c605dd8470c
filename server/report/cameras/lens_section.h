// What is different between the lenses of two revisions, on the page that compares them.
#pragma once

#include "server/report/frame/page.h"
#include "server/report/robot_pages.h"

namespace rigcal::report {

// LENSES with a map of each camera, the farthest off first; nothing where there is no camera.
void FillLenses(Dictionary& page, const ComparedLenses& lenses);

}  // namespace rigcal::report
