#include "client/exit_code.h"

namespace rigcal::client {

ExitCode ExitCodeOf(const Error& error) {
  return error.code == ErrorCode::kUnreachable ? ExitCode::kUnreachable : ExitCode::kRefused;
}

ExitCode Report(const Error& error, std::ostream& err) {
  err << "rigcal: " << Sentence(error) << std::endl;
  return ExitCodeOf(error);
}

}  // namespace rigcal::client
