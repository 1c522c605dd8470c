// Who may give which order over HTTP, and that no other site's page makes a browser give one.
#include <gmock/gmock.h>

#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;

const std::string kAdaSecret(64, 'a');

class OrdersTest : public HttpFixture {
 protected:
  void SetUp() override {
    HttpFixture::SetUp();
    options_.logins.are_needed = [this]() -> Result<bool> { return has_users_; };
    options_.logins.of_session = [](const std::string& secret) -> Result<std::optional<Person>> {
      return secret == kAdaSecret ? std::optional(Person{"ada", Role::kApprover}) : std::nullopt;
    };
    options_.logins.of_token = [](const std::string& secret) -> Result<std::optional<Person>> {
      const auto role = RoleOf(secret);
      return role ? std::optional(Person{"program", *role}) : std::nullopt;
    };
    options_.orders.role_of = [](const std::string& verb) {
      return verb == "approve" ? std::optional(Role::kApprover) : std::nullopt;
    };
    options_.orders.give = [this](const std::string& verb, const std::string& json,
                                  const Person& person) -> Result<std::string> {
      given_.push_back(person.name + " " + verb + " " + json);
      if (json == "{\"throw\":1}") throw std::runtime_error("no memory");
      if (json == "{\"late\":1}") return Fail(ErrorCode::kConflict, "it was retired", "Look.");
      return "{\"done\":true}";
    };
    port_ = Start();
  }
  Reply Post(const std::string& path, const std::string& body, const std::string& headers,
             const std::string& type = "application/json") const {
    const Socket socket(port_);
    socket.Send("POST " + path + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "Content-Type: " + type +
                "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
    return Parsed(socket.ReadAll());
  }
  static std::string Bearer(const std::string& role) { return "Authorization: Bearer " + role + "\r\n"; }
  std::string Cookie() const { return "Cookie: rigcal-" + std::to_string(port_) + "=" + kAdaSecret + "\r\n"; }
  std::string FormToken() const {
    const std::string page = Get(port_, "/login", Cookie()).body;
    return "X-Rigcal-Form: " + page.substr(page.find("name=\"form\" value=\"") + 19, 64) + "\r\n";
  }

  int port_ = 0;
  bool has_users_ = true;
  std::vector<std::string> given_;
};

TEST_F(OrdersTest, TakeTheirRole) {
  for (const std::string role : {"viewer", "technician"}) {
    const Reply refused = Post("/api/v1/approve", "{}", Bearer(role));
    EXPECT_EQ(refused.status, 403);
    EXPECT_THAT(refused.body, HasSubstr("approve takes the role approver, and program is " + role));
  }
  EXPECT_EQ(Post("/api/v1/approve", "{}", "").status, 401);
  EXPECT_TRUE(given_.empty());
  for (const std::string role : {"approver", "admin"})
    EXPECT_EQ(Post("/api/v1/approve", "{\"robot\":\"r\"}", Bearer(role)).body, "{\"done\":true}");
  EXPECT_EQ(given_, std::vector<std::string>(2, "program approve {\"robot\":\"r\"}"));
}

TEST_F(OrdersTest, OfABrowserComeFromItsOwnPage) {
  const std::string own = "Origin: http://localhost\r\n", form = FormToken();
  EXPECT_EQ(Post("/api/v1/approve", "{}", Cookie() + own).status, 403);
  EXPECT_EQ(Post("/api/v1/approve", "{}", Cookie() + form).status, 403);
  EXPECT_EQ(Post("/api/v1/approve", "{}", Cookie() + form + "Origin: http://localhost:1\r\n").status, 403);
  EXPECT_EQ(Post("/api/v1/approve", "{}", Cookie() + own + "X-Rigcal-Form: " + std::string(64, 'e') + "\r\n").status,
            403);
  EXPECT_TRUE(given_.empty());
  EXPECT_EQ(Post("/api/v1/approve", "{}", Cookie() + own + form).status, 200);
}

TEST_F(OrdersTest, RefusalsSayWhat) {
  EXPECT_EQ(Post("/api/v1/approve", "{\"late\":1}", Bearer("admin")).status, 409);
  EXPECT_EQ(Post("/api/v1/approve", "a=b", Bearer("admin"), "application/x-www-form-urlencoded").status, 415);
  EXPECT_EQ(Post("/api/v1/approve", std::string(70'000, ' '), Bearer("admin")).status, 413);
  EXPECT_EQ(Post("/api/v1/status", "{}", Bearer("admin")).status, 405) << "no order";
  EXPECT_EQ(Post("/other", "{}", Bearer("admin")).status, 405);
  EXPECT_EQ(Get(port_, "/api/v1/approve", Bearer("admin")).body, "path /api/v1/approve query ")
      << "GET changes nothing";
}

TEST_F(OrdersTest, ThatThrowAreAnsweredAndEndNothing) {
  EXPECT_EQ(Post("/api/v1/approve", "{\"throw\":1}", Bearer("admin")).status, 503);
  EXPECT_EQ(Post("/api/v1/approve", "{}", Bearer("admin")).status, 200);
}

TEST_F(OrdersTest, AreTakenOfNobodyWhereThereAreNoLogins) {
  has_users_ = false;
  EXPECT_EQ(Post("/api/v1/approve", "{}", Bearer("admin")).status, 405);
  EXPECT_TRUE(given_.empty());
}

}  // namespace
}  // namespace rigcal::http
