// Who is let in, through real sockets: strangers, people, programs, and those who pretend.
#include <gmock/gmock.h>

#include <mutex>
#include <set>

#include "tests/unit/http/made_certificate.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSession(64, 'a'), kToken(64, 'b');

class LoginsTest : public HttpFixture {
 protected:
  int StartGuarded() {
    options_.logins.are_needed = [this]() -> Result<bool> { return has_users_; };
    options_.logins.of_session = [this](const std::string& secret) -> Result<std::optional<Person>> {
      const std::lock_guard lock(mutex_);
      return sessions_.count(secret) > 0 ? std::optional(Person{"ada", Role::kApprover}) : std::nullopt;
    };
    options_.logins.of_token = [](const std::string& secret) -> Result<std::optional<Person>> {
      if (secret == "throw") throw std::runtime_error("no memory");
      return secret == kToken ? std::optional(Person{"grafana", Role::kViewer}) : std::nullopt;
    };
    options_.logins.begin = [this](const std::string& name,
                                   const std::string& password) -> Result<std::optional<std::string>> {
      if (name == "thrower") throw std::runtime_error("no memory");
      if (name != "ada" || password != "correct horse battery") return std::optional<std::string>();
      const std::lock_guard lock(mutex_);
      return std::optional(*sessions_.insert(kSession).first);
    };
    options_.logins.end = [this](const std::string& secret) -> Status {
      const std::lock_guard lock(mutex_);
      sessions_.erase(secret);
      return {};
    };
    port_ = Start([](const std::string& path, const std::string&) -> Result<Page> {
      return Page{"<main>of " + path + "</main>", "text/html; charset=utf-8"};
    });
    return port_;
  }
  std::string Cookie(const std::string& name, const std::string& secret) const {
    return "Cookie: " + name + "-" + std::to_string(port_) + "=" + secret + "\r\n";
  }
  std::string Session() const { return Cookie("rigcal", kSession); }
  Reply Post(const std::string& path, const std::string& body,
             const std::string& headers = "Origin: http://localhost\r\n",
             const std::string& type = "application/x-www-form-urlencoded") const {
    const Socket socket(port_);
    socket.Send("POST " + path + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "Content-Type: " + type +
                "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
    return Parsed(socket.ReadAll());
  }
  // Of the form that a page holds.
  static std::string FormToken(const Reply& page) {
    const std::size_t at = page.body.find("name=\"form\" value=\"");
    return at == std::string::npos ? "" : page.body.substr(at + 19, 64);
  }
  Reply LogIn(const std::string& password, const std::string& more = "") const {
    const std::string token = FormToken(Get(port_, "/login"));
    return Post("/login", "name=ada&password=" + password + "&form=" + token + more,
                "Origin: http://localhost\r\n" + Cookie("rigcal-form", token));
  }

  int port_ = 0;
  std::atomic<bool> has_users_{true};
  std::mutex mutex_;
  std::set<std::string> sessions_;
};

const std::string kBrowser = "Accept: text/html,*/*\r\n";

TEST_F(LoginsTest, WithoutUsersAllIsAsBefore) {
  has_users_ = false;
  StartGuarded();
  EXPECT_EQ(Get(port_, "/").body, "<main>of /</main>");
  EXPECT_EQ(Get(port_, "/login").body, "<main>of /login</main>");
  EXPECT_EQ(Post("/login", "name=ada").status, 405);
  has_users_ = true;
  EXPECT_EQ(Get(port_, "/").status, 401);
}

TEST_F(LoginsTest, StrangersReadNothingButHowTheServerIs) {
  StartGuarded();
  for (const std::string path :
       {"/", "/metrics", "/api/v1/robots", "/robots/mapper-01/revisions/7/",
        "/robots/mapper-01/revisions/7/evidence/ab.jpg", "/robots/mapper-01", "/nothing", "/assets/x.js"}) {
    const Reply reply = Get(port_, path);
    EXPECT_EQ(reply.status, 401) << path;
    EXPECT_EQ(reply.headers.at("www-authenticate"), "Bearer realm=\"rigcal\"") << path;
    EXPECT_THAT(reply.body, Not(HasSubstr("seven"))) << path;
  }
  EXPECT_THAT(Get(port_, "/api/v1/robots").headers.at("content-type"), HasSubstr("json"));
  for (const std::string path : {"/healthz", "/readyz", "/style.css"}) EXPECT_EQ(Get(port_, path).status, 200) << path;
  for (const std::string method : {"POST", "PUT", "DELETE"}) EXPECT_EQ(Ask(port_, method, "/").status, 401) << method;
}

TEST_F(LoginsTest, BrowsersAreLedToTheLoginAndBack) {
  StartGuarded();
  const Reply led = Get(port_, "/robots/a/compare?a=1&b=2", kBrowser);
  EXPECT_EQ(led.status, 303);
  EXPECT_EQ(led.headers.at("location"), "/login?next=/robots/a/compare%3Fa%3D1%26b%3D2");
  const Reply page = Get(port_, led.headers.at("location"), kBrowser);
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.body, HasSubstr("name=\"next\" value=\"/robots/a/compare?a=1&amp;b=2\""));
  EXPECT_EQ(page.headers.at("referrer-policy"), "same-origin") << "else browsers send their form with Origin: null";
  EXPECT_EQ(page.headers.at("cache-control"), "no-store");
  EXPECT_EQ(LogIn("correct+horse+battery", "&next=%2Frobots%2Fa%2F").headers.at("location"), "/robots/a/");
  EXPECT_EQ(LogIn("correct+horse+battery", "&next=%2F%2Fevil.example").headers.at("location"), "/");
}

// The browser leaves the cookie out; from a page of this server it does not.
TEST_F(LoginsTest, LinkOfAnotherSiteComesBackFromHere) {
  StartGuarded();
  const Reply reply = Get(port_, "/robots/a/?x=1", kBrowser + "Sec-Fetch-Site: cross-site\r\n");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.headers.at("refresh"), "0; url=/robots/a/?x=1");
  EXPECT_THAT(reply.body, Not(HasSubstr("of /robots")));
}

TEST_F(LoginsTest, LoginGivesASessionOfItsOwn) {
  StartGuarded();
  EXPECT_EQ(Get(port_, "/", Session()).status, 401) << "a secret that nobody gave is none";
  const Reply in = LogIn("correct+horse+battery");
  EXPECT_EQ(in.status, 303);
  const Socket socket(port_);
  const std::string token = FormToken(Get(port_, "/login"));
  const std::string body = "name=ada&password=correct+horse+battery&form=" + token;
  socket.Send("POST /login HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\n" + Cookie("rigcal-form", token) +
              "Content-Type: application/x-www-form-urlencoded\r\nContent-Length: " + std::to_string(body.size()) +
              "\r\n\r\n" + body);
  EXPECT_THAT(socket.ReadAll(), HasSubstr("Set-Cookie: rigcal-" + std::to_string(port_) + "=" + kSession +
                                          "; Path=/; HttpOnly; SameSite=Strict\r\n"));
  const Reply page = Get(port_, "/", Session());
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.body, HasSubstr("ada, approver"));
  EXPECT_EQ(Get(port_, "/robots/mapper-01/revisions/7/", Session()).body, "<p>seven</p>");
  EXPECT_EQ(Ask(port_, "POST", "/", Session()).status, 405);
}

TEST_F(LoginsTest, SecretOfBeforeTheLoginEndsWithIt) {
  StartGuarded();
  const std::string planted(64, 'c');
  sessions_.insert(planted);  // of whoever planted it
  const std::string token = FormToken(Get(port_, "/login"));
  const Reply in = Post("/login", "name=ada&password=correct+horse+battery&form=" + token,
                        "Origin: http://localhost\r\nCookie: rigcal-form-" + std::to_string(port_) + "=" + token +
                            "; rigcal-" + std::to_string(port_) + "=" + planted + "\r\n");
  EXPECT_EQ(in.status, 303);
  EXPECT_EQ(Get(port_, "/", Cookie("rigcal", planted)).status, 401);
  EXPECT_EQ(Get(port_, "/", Session()).status, 200);
}

TEST_F(LoginsTest, WrongPasswordIsSaidAndTriedSlowly) {
  StartGuarded();
  const Reply wrong = LogIn("wrong");
  EXPECT_EQ(wrong.status, 403);
  EXPECT_THAT(wrong.body, HasSubstr("There is no such name with this password."));
  EXPECT_THAT(wrong.body, HasSubstr("value=\"ada\""));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(LogIn("wrong").status, 403);
  const Reply often = LogIn("correct+horse+battery");
  EXPECT_EQ(often.status, 429);
  EXPECT_EQ(often.headers.at("retry-after"), "15");
  EXPECT_TRUE(sessions_.empty());
}

TEST_F(LoginsTest, BehindATrustedProxyNobodyShutsOutOthers) {
  options_.proxy = "127.0.0.1";
  StartGuarded();
  const std::string token = FormToken(Get(port_, "/login"));
  const auto log_in = [&](const std::string& password, const std::string& from) {
    return Post("/login", "name=ada&password=" + password + "&form=" + token,
                "Origin: http://localhost\r\nX-Forwarded-For: " + from + "\r\n" + Cookie("rigcal-form", token))
        .status;
  };
  for (int i = 0; i < 5; ++i) EXPECT_EQ(log_in("wrong", "10.0.0.9, 10.0.0.1"), 403);
  EXPECT_EQ(log_in("wrong", "10.0.0." + std::to_string(20) + ", 10.0.0.1"), 429)
      << "what the client itself sent is not believed";
  EXPECT_EQ(log_in("correct+horse+battery", "10.0.0.2"), 303);
}

// Whoever shares its address, or guesses its user's password from many.
TEST_F(LoginsTest, BrowserOfBeforeIsNotShutOutByOthers) {
  StartGuarded();
  const std::string token = FormToken(Get(port_, "/login")), form = "&form=" + token;
  const auto log_in = [&](const std::string& password, const std::string& mark) {
    const std::string known = mark.empty() ? "" : "; rigcal-known-" + std::to_string(port_) + "=" + mark;
    const Socket socket(port_);
    const std::string body = "name=ada&password=" + password + form;
    socket.Send("POST /login HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nCookie: rigcal-form-" +
                std::to_string(port_) + "=" + token + known +
                "\r\nContent-Type: application/x-www-form-urlencoded\r\nContent-Length: " +
                std::to_string(body.size()) + "\r\n\r\n" + body);
    return socket.ReadAll();
  };
  const std::string in = log_in("correct+horse+battery", ""),
                    name = "Set-Cookie: rigcal-known-" + std::to_string(port_) + "=";
  ASSERT_THAT(in, HasSubstr(name));
  const std::string mark = in.substr(in.find(name) + name.size(), 64);
  EXPECT_THAT(in.substr(in.find(name)), HasSubstr("; HttpOnly; SameSite=Strict; Max-Age=31536000\r\n"));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(Parsed(log_in("wrong", "")).status, 403);
  EXPECT_EQ(Parsed(log_in("correct+horse+battery", "")).status, 429);
  EXPECT_EQ(Parsed(log_in("correct+horse+battery", std::string(64, 'a'))).status, 429) << "a mark that nobody gave";
  const std::string again = log_in("correct+horse+battery", mark);
  EXPECT_EQ(Parsed(again).status, 303);
  EXPECT_THAT(again, HasSubstr(name + mark)) << "another would give it more tries";
  for (int i = 0; i < 4; ++i) EXPECT_EQ(Parsed(log_in("wrong", mark)).status, 403);
  EXPECT_EQ(Parsed(log_in("wrong", mark)).status, 429);
}

TEST_F(LoginsTest, OfAnybodyElseTheHeaderIsNotBelieved) {
  options_.proxy = "10.0.0.1";
  StartGuarded();
  const std::string token = FormToken(Get(port_, "/login"));
  int status = 0;
  for (int i = 0; i < 6; ++i)
    status = Post("/login", "name=ada&password=wrong&form=" + token,
                  "Origin: http://localhost\r\nX-Forwarded-For: 10.0.0." + std::to_string(i) + "\r\n" +
                      Cookie("rigcal-form", token))
                 .status;
  EXPECT_EQ(status, 429);
}

TEST_F(LoginsTest, FormsOfOtherPagesAreRefused) {
  StartGuarded();
  const std::string token = FormToken(Get(port_, "/login"));
  const std::string good = "name=ada&password=correct+horse+battery&form=" + token,
                    cookie = Cookie("rigcal-form", token);
  EXPECT_EQ(Post("/login", good, cookie).status, 403) << "no Origin";
  EXPECT_EQ(Post("/login", good, cookie + "Origin: http://localhost:1\r\n").status, 403) << "another port";
  EXPECT_EQ(Post("/login", good, cookie + "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(Post("/login", good, cookie + "Origin: null\r\n").status, 403);
  EXPECT_EQ(Post("/login", good).status, 403) << "no cookie";
  EXPECT_EQ(Post("/login", "name=ada&password=correct+horse+battery&form=" + std::string(64, 'd'),
                 cookie + "Origin: http://localhost\r\n")
                .status,
            403);
  EXPECT_TRUE(sessions_.empty());
  EXPECT_EQ(Post("/login", good, cookie + "Origin: http://localhost\r\n").status, 303);
}

TEST_F(LoginsTest, LogoutNeedsItsFormAndEndsTheSession) {
  StartGuarded();
  ASSERT_EQ(LogIn("correct+horse+battery").status, 303);
  const Reply account = Get(port_, "/login", Session());
  EXPECT_THAT(account.body, HasSubstr("Logged in as approver"));
  const std::string own = "Origin: http://localhost\r\n" + Session();
  EXPECT_EQ(Post("/logout", "form=x", own).status, 403);
  EXPECT_EQ(Post("/logout", "form=" + FormToken(account), Session()).status, 403);
  EXPECT_EQ(Ask(port_, "GET", "/logout", Session()).status, 405);
  EXPECT_EQ(Get(port_, "/", Session()).status, 200);
  EXPECT_EQ(Post("/logout", "form=" + FormToken(account), own).headers.at("location"), "/login");
  EXPECT_EQ(Get(port_, "/", Session()).status, 401);
}

TEST_F(LoginsTest, ProgramsComeWithTokens) {
  StartGuarded();
  const std::string token = "Authorization: Bearer " + kToken + "\r\n";
  const Reply reply = Get(port_, "/", token);
  EXPECT_EQ(reply.body, "<main>of /</main>");
  EXPECT_EQ(Get(port_, "/metrics", "Authorization: Bearer x\r\n").status, 401);
  ASSERT_EQ(LogIn("correct+horse+battery").status, 303);
  EXPECT_EQ(Get(port_, "/", Session() + "Authorization: Bearer x\r\n").status, 401)
      << "a bad token is not made good by a cookie";
  EXPECT_EQ(Get(port_, "/", "Authorization: Basic YWRhOng=\r\n").status, 401);
}

TEST_F(LoginsTest, BodiesOfLoginsAreBounded) {
  StartGuarded();
  const std::string own = "Origin: http://localhost\r\n";
  EXPECT_EQ(Post("/login", std::string(9000, 'a'), own).status, 413);
  EXPECT_EQ(Post("/login", "{}", own, "application/json").status, 415);
  EXPECT_EQ(Ask(port_, "POST", "/login", own + "Transfer-Encoding: chunked\r\n").status, 411);
}

TEST_F(LoginsTest, StoreThatFailsLetsNobodyIn) {
  options_.logins.are_needed = []() -> Result<bool> {
    return Fail(ErrorCode::kStorage, "the disk is gone", "Mend it.");
  };
  port_ = Start();
  EXPECT_EQ(Get(port_, "/").status, 503);
  EXPECT_EQ(Get(port_, "/robots/mapper-01/revisions/7/").status, 503);
  EXPECT_EQ(Get(port_, "/healthz").status, 200);
}

TEST_F(LoginsTest, WhatThrowsLetsNobodyInAndEndsNothing) {
  StartGuarded();
  const std::string token = FormToken(Get(port_, "/login"));
  const auto log_in = [&] {
    return Post("/login", "name=thrower&password=x&form=" + token,
                "Origin: http://localhost\r\n" + Cookie("rigcal-form", token))
        .status;
  };
  EXPECT_EQ(log_in(), 503);
  EXPECT_EQ(Get(port_, "/", "Authorization: Bearer throw\r\n").status, 503);
  EXPECT_EQ(LogIn("correct+horse+battery").status, 303);
}

TEST_F(LoginsTest, CookiesOverTlsAreForTlsAlone) {
  const MadeCertificate made(root_, "first");
  options_.certificate = Certificate::Load(made.certificate, made.key).value();
  StartGuarded();
  const SecureReply page = GetSecurely(port_, "/login");
  EXPECT_THAT(page.reply.headers.at("set-cookie"), ::testing::StartsWith("__Host-rigcal-form-"));
  EXPECT_THAT(page.reply.headers.at("set-cookie"), HasSubstr("; Secure"));
}

TEST_F(LoginsTest, OpenServerWithUsersSaysNothingOfBeingOpen) {
  options_.is_open = true;
  StartGuarded();
  const Reply page = Get(port_, "/login");
  EXPECT_THAT(page.body, Not(HasSubstr("Anyone on this network")));
  has_users_ = false;
  EXPECT_THAT(Get(port_, "/").body, HasSubstr("Anyone on this network"));
}

}  // namespace
}  // namespace rigcal::http
