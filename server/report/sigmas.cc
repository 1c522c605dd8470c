#include "server/report/sigmas.h"

#include <cmath>

#include "server/report/text.h"

namespace rigcal::report {

const char* SigmasClass(double in_sigmas) {
  if (in_sigmas < 1.0) return "fit0";
  if (in_sigmas < 2.0) return "fit1";
  return in_sigmas < kOff_sigmas ? "fit2" : "fit3";
}

std::string SigmasText(double in_sigmas) {
  return Fixed(in_sigmas < kOff_sigmas ? std::floor(in_sigmas * 10.0) / 10.0 : in_sigmas, 1);
}

}  // namespace rigcal::report
