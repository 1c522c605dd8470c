#include "server/http/pages/login_page.h"

#include "server/http/pages/html_text.h"

namespace rigcal::http {
namespace {

std::string Hidden(const std::string& name, const std::string& value) {
  return "<input type=\"hidden\" name=\"" + name + "\" value=\"" + Escaped(value) + "\">";
}

std::string MayText(Role role) {
  switch (role) {
    case Role::kViewer:
      return "You may read everything.";
    case Role::kTechnician:
      return "You may read everything, retire and restore, begin epochs, measure boards and compute again.";
    case Role::kApprover:
      return "You may do all that a technician may, and approve, reject and roll back.";
    case Role::kAdmin:
      break;
  }
  return "You may do all that an approver may, and set policies and rig models.";
}

}  // namespace

std::string WriteLoginPage(const LoginPage& page) {
  const std::string wrong =
      page.what_is_wrong.empty() ? "" : "<p class=\"refused\" role=\"alert\">" + Escaped(page.what_is_wrong) + "</p>";
  return PageAround(
      "Log in to Rigcal",
      "<section class=\"card login\"><h1>Log in to Rigcal</h1>" + wrong + "<form action=\"/login\" method=\"post\">" +
          Hidden("form", page.form_token) + Hidden("next", page.next) +
          "<label>Name <input type=\"text\" name=\"name\" value=\"" + Escaped(page.name) +
          "\" required maxlength=\"64\" autocomplete=\"username\" autocapitalize=\"none\" spellcheck=\"false\"" +
          (page.name.empty() ? " autofocus" : "") +
          "></label><label>Password <input type=\"password\" name=\"password\" required maxlength=\"1024\" "
          "autocomplete=\"current-password\"" +
          (page.name.empty() ? "" : " autofocus") +
          "></label><button>Log in</button></form>"
          "<p class=\"hint\">Whoever keeps this server gives names and passwords: <code>rigcal user add "
          "NAME</code>.</p></section>");
}

std::string WriteAccountPage(const Person& person, const std::string& form_token) {
  return PageAround("Your login at Rigcal",
                    "<nav class=\"crumbs\" aria-label=\"Where you are\"><a href=\"/\">Fleet</a></nav>"
                    "<section class=\"card login\"><h1>" +
                        Escaped(person.name) + "</h1><p class=\"meta\">Logged in as " + NameOf(person.role) +
                        "</p><p>" + MayText(person.role) + "</p><form action=\"/logout\" method=\"post\">" +
                        Hidden("form", form_token) + "<button>Log out</button></form></section>");
}

std::string PersonNotice(const Person& person) {
  return "<p class=\"meta logged-in\"><a href=\"/login\">" + Escaped(person.name) + ", " + NameOf(person.role) +
         "</a></p>";
}

}  // namespace rigcal::http
