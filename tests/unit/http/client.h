// A socket and nothing else: sends bytes, reads until the server closes.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "server/http/server.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::http {

class Socket {
 public:
  // `from`: which of this machine's own addresses it comes from.
  explicit Socket(int port, const char* from = "127.0.0.1")
      : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    ::inet_pton(AF_INET, from, &own.sin_addr);
    EXPECT_EQ(::bind(descriptor_, reinterpret_cast<sockaddr*>(&own), sizeof own), 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    timeval patience{20, 0};
    ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    connected_ = ::connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~Socket() { ::close(descriptor_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  [[nodiscard]] bool connected() const { return connected_; }
  void Send(const std::string& text) const { (void)!::send(descriptor_, text.data(), text.size(), MSG_NOSIGNAL); }
  // By the other side, after what it may have sent.
  [[nodiscard]] bool ClosesWithin(int ms) const {
    pollfd waits{descriptor_, POLLIN, 0};
    char bytes[256];
    return ::poll(&waits, 1, ms) > 0 && ::recv(descriptor_, bytes, sizeof bytes, MSG_DONTWAIT) <= 0;
  }
  // At most `at_once` of what comes; 0 once the other side has closed.
  [[nodiscard]] std::size_t CountPiece(std::size_t at_once) const {
    std::string piece(at_once, ' ');
    return static_cast<std::size_t>(std::max<ssize_t>(::recv(descriptor_, piece.data(), at_once, 0), 0));
  }
  [[nodiscard]] std::string ReadAll() const {
    std::string all;
    std::array<char, 65536> buffer{};
    for (ssize_t got = 0; (got = ::recv(descriptor_, buffer.data(), buffer.size(), 0)) > 0;)
      all.append(buffer.data(), static_cast<std::size_t>(got));
    return all;
  }

 private:
  int descriptor_;
  bool connected_ = false;
};

struct Reply {
  int status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
};

inline Reply Parsed(const std::string& text) {
  Reply reply;
  const auto end = text.find("\r\n\r\n");
  if (text.rfind("HTTP/1.1 ", 0) != 0 || end == std::string::npos) return reply;
  reply.status = std::atoi(text.c_str() + 9);
  reply.body = text.substr(end + 4);
  for (auto at = text.find("\r\n") + 2; at < end;) {
    const auto stop = text.find("\r\n", at);
    const std::string line = text.substr(at, stop - at);
    std::string name = line.substr(0, line.find(':'));
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    reply.headers[name] = line.substr(std::min(line.size(), line.find(':') + 2));
    at = stop + 2;
  }
  return reply;
}

inline Reply Ask(int port, const std::string& method, const std::string& target, const std::string& headers = "") {
  const Socket socket(port);
  socket.Send(method + " " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n");
  return Parsed(socket.ReadAll());
}
inline Reply Get(int port, const std::string& target, const std::string& headers = "") {
  return Ask(port, "GET", target, headers);
}

// A server over a temporary folder with one published revision.
class HttpFixture : public ::testing::Test {
 protected:
  void SetUp() override {
    Write("outside.txt", "secret");
    Write("reports/mapper-01/7/index.html", "<p>seven</p>");
    Write("reports/mapper-01/7/style.css", "p{}");
    Write("reports/mapper-01/7/revision.json", "0123456789");
    Write("reports/mapper-01/7/evidence/ab.jpg", "JPEG");
    Write("reports/mapper-01/7/.hidden", "secret");
    Write("reports/mapper-01/.new-8/index.html", "secret");
    options_.folder = root_ / "reports";
  }
  void TearDown() override { server_.reset(); }
  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name, std::ios::binary) << text;
  }
  int Start(Answer answer = [](const std::string& path, const std::string& query) -> Result<Page> {
    return Page{"path " + path + " query " + query, "text/plain; charset=utf-8"};
  }) {
    auto server = Server::Start(options_, std::move(answer));
    EXPECT_TRUE(server) << (server ? "" : server.error().what);
    if (!server) return 0;
    server_ = std::make_unique<Server>(std::move(*server));
    return server_->port();
  }

  TempFolder place_;
  const std::filesystem::path root_ = place_.path();
  Options options_;
  std::unique_ptr<Server> server_;
};

}  // namespace rigcal::http
