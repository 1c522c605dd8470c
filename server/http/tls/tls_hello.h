// The first bytes of a connection to a server with TLS. Pure.
#pragma once

#include <string>
#include <string_view>

namespace rigcal::http {

// kPartial: read on. kHello: the first record of a handshake is whole. kPlain: it is no TLS.
enum class Hello { kPartial, kHello, kPlain };
// Of all that was read of a connection until now.
[[nodiscard]] Hello JudgeHello(std::string_view bytes);

// What a client that speaks plain HTTP is told: one whole answer, 400.
[[nodiscard]] std::string AnswerToPlainHttp();

}  // namespace rigcal::http
