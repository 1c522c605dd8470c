// Result<T>: a value, or an Error that names the thing that is wrong and its cure.
// Expected failures are values; exceptions of libraries are caught in the module that calls the library.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace rigcal {

enum class ErrorCode {
  kInvalidInput,  // what came in is wrong: the person who sent it can mend it
  kNotFound,      // the thing asked for does not exist
  kConflict,      // it contradicts what is stored
  kBusy,          // a named limit is reached; the same call may succeed later
  kUnreachable,   // the other side does not answer
  kUnsupported,   // newer or other than this version understands
  kStorage,       // disk or database failed
  kInternal,      // our own fault
};

// `what` names the thing that is wrong (file, capture, sensor, field); `cure` says what the person can do.
struct [[nodiscard]] Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string what;
  std::string cure;
};

template <typename T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

// `what` names the thing that is wrong, without a full stop; `cure` says in whole sentences what the person can do.
[[nodiscard]] inline tl::unexpected<Error> Fail(ErrorCode code, std::string what, std::string cure) {
  return tl::unexpected<Error>(Error{code, std::move(what), std::move(cure)});
}
[[nodiscard]] inline tl::unexpected<Error> Fail(Error error) { return tl::unexpected<Error>(std::move(error)); }

// "session.yaml line 4: ... . Cure." in one line, for terminals and logs.
[[nodiscard]] std::string Sentence(const Error& error);
// "invalid_input", "not_found", ...: the spelling on the wire and in JSON. Unknown names give kInternal.
[[nodiscard]] std::string NameOf(ErrorCode code);
[[nodiscard]] ErrorCode ErrorCodeOf(const std::string& name);

}  // namespace rigcal

// RIGCAL_TRY(expr): returns the error of a failed Result, Status or other expected from the enclosing function.
#define RIGCAL_CONCAT_INNER(a, b) a##b
#define RIGCAL_CONCAT(a, b) RIGCAL_CONCAT_INNER(a, b)
#define RIGCAL_TRY(expr) RIGCAL_TRY_IMPL(RIGCAL_CONCAT(rigcal_try_, __COUNTER__), expr)
#define RIGCAL_TRY_IMPL(result, expr)                                \
  do {                                                               \
    auto&& result = (expr);                                          \
    if (!result) return ::tl::unexpected(std::move(result).error()); \
  } while (false)
// RIGCAL_ASSIGN(auto value, Compute()): the value, or returns the error.
#define RIGCAL_ASSIGN(declaration, expr) \
  RIGCAL_ASSIGN_IMPL(RIGCAL_CONCAT(rigcal_result_, __COUNTER__), declaration, expr)
#define RIGCAL_ASSIGN_IMPL(result, declaration, expr)              \
  auto result = (expr);                                            \
  if (!result) return ::tl::unexpected(std::move(result).error()); \
  declaration = std::move(*result)
