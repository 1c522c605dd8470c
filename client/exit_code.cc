#include "client/exit_code.h"

namespace rigcal::client {

ExitCode ExitCodeOf(const Error& error) {
  const bool is_unreachable = error.code == ErrorCode::kUnreachable || error.code == ErrorCode::kAmbiguous;
  return is_unreachable ? ExitCode::kUnreachable : ExitCode::kRefused;
}

ExitCode Report(const Error& error, std::ostream& err) {
  err << "rigcal: " << Sentence(error) << std::endl;
  return ExitCodeOf(error);
}

}  // namespace rigcal::client
