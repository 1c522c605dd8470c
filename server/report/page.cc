#include "server/report/page.h"

#include <ctemplate/template.h>
#include <ctemplate/template_cache.h>

#include "report_embedded.h"

namespace rigcal::report {
namespace {

bool IsTemplate(std::string_view name) { return name.size() > 4 && name.substr(name.size() - 4) == ".tpl"; }

struct Templates {
  ctemplate::TemplateCache cache;
  bool complete = true;
  Templates() {
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

void ShowValue(Dictionary& parent, const char* section, const char* variable, const std::string& value) {
  parent.AddSectionDictionary(section)->SetValue(variable, value);
}

}  // namespace rigcal::report
