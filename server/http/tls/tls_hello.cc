#include "server/http/tls/tls_hello.h"

namespace rigcal::http {

// RFC 8446, 5.1: type 22, version 3.x, length in two bytes.
Hello JudgeHello(std::string_view bytes) {
  constexpr std::size_t kHeadBytes = 5;
  constexpr std::string_view kBegin{"\x16\x03", 2};
  if (bytes.substr(0, kBegin.size()) != kBegin.substr(0, bytes.size())) return Hello::kPlain;
  if (bytes.size() < kHeadBytes) return Hello::kPartial;
  const std::size_t record_bytes = static_cast<unsigned char>(bytes[3]) * 256U + static_cast<unsigned char>(bytes[4]);
  return bytes.size() < kHeadBytes + record_bytes ? Hello::kPartial : Hello::kHello;
}

std::string AnswerToPlainHttp() {
  const std::string body = "This server speaks https only: ask for this address with https:// instead of http://.\n";
  return "HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: " +
         std::to_string(body.size()) +
         "\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n" + body;
}

}  // namespace rigcal::http
