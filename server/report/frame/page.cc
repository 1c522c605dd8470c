#include "server/report/frame/page.h"

#include <ctemplate/template.h>
#include <ctemplate/template_cache.h>
#include <ctemplate/template_modifiers.h>

#include <string_view>

#include "report_embedded.h"

namespace rigcal::report {
namespace {

bool IsTemplate(std::string_view name) { return name.size() > 4 && name.substr(name.size() - 4) == ".tpl"; }

// {{NAME:x-typed}}: what stands between two backticks is what a person types, and is kept in one piece. A stop behind
// the last one is left out: it would be copied along, and on a narrow page stand in a line of its own.
class Typed : public ctemplate::TemplateModifier {
 public:
  void Modify(const char* in, std::size_t size, const ctemplate::PerExpandData* data, ctemplate::ExpandEmitter* out,
              const std::string& arg) const override {
    const auto escape = [&](std::string_view part) {
      ctemplate::html_escape.Modify(part.data(), part.size(), data, out, arg);
    };
    std::string_view text(in, size);
    while (true) {
      const std::size_t open = text.find('`');
      const std::size_t close = open == std::string_view::npos ? open : text.find('`', open + 1);
      if (close == std::string_view::npos) return escape(text);
      escape(text.substr(0, open));
      out->Emit(std::string("<code class=\"typed\">"));
      escape(text.substr(open + 1, close - open - 1));
      out->Emit(std::string("</code>"));
      text.remove_prefix(close + 1);
      if (text == ".") return;
    }
  }
};

struct Templates {
  Typed typed;
  ctemplate::TemplateCache cache;
  bool complete = true;
  Templates() {
    complete = ctemplate::AddXssSafeModifier("x-typed", &typed);
    for (const auto& [name, text] : embedded::kEmbeddedFiles)
      if (IsTemplate(name))
        complete &=
            cache.StringToTemplateCache(std::string(name), text.data(), text.size(), ctemplate::STRIP_WHITESPACE);
  }
};

}  // namespace

Result<std::string> Expand(const std::string& template_name, const Dictionary& values) {
  static Templates templates;
  std::string text;
  if (!templates.complete ||
      !templates.cache.ExpandWithData(template_name, ctemplate::STRIP_WHITESPACE, &values, nullptr, &text))
    return Fail(ErrorCode::kInternal, "the page template " + template_name + " cannot be filled",
                "This is a fault of the program: report it with its version.");
  return text;
}

void FillHead(Dictionary& page, const std::string& title, const std::string& root) {
  Dictionary* head = page.AddIncludeDictionary("HEAD");
  head->SetFilename("head.tpl");
  head->SetValue("TITLE", title);
  head->SetValue("ROOT", root);
}

void AddScript(Dictionary& page, const std::string& path) { ShowValue(page, "SCRIPT", "PATH", path); }

void AddScriptsLater(Dictionary& page, const std::string& later, const std::vector<std::string>& paths) {
  std::string names;
  for (const std::string& path : paths) names += (names.empty() ? "" : " ") + path;
  Dictionary* section = page.AddSectionDictionary("LATER");
  section->SetValue("PATH", later);
  section->SetValue("SCRIPTS", names);
}

void ShowValue(Dictionary& parent, const char* section, const char* variable, const std::string& value) {
  parent.AddSectionDictionary(section)->SetValue(variable, value);
}

}  // namespace rigcal::report
