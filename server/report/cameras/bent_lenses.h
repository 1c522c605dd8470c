// The table of lenses that bend beyond their model, in the section "Joint refinement" of a revision.
#pragma once

#include <vector>

#include "server/model/sensors/lens_misfit.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// BENT with a row per camera: how far it bends, and how well each model that was tried foretells pictures that were
// left out. Nothing where none bends.
void FillBentLenses(Dictionary& section, const std::vector<LensMisfit>& lenses);

}  // namespace rigcal::report
