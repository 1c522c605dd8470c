// Fills the embedded templates. Every template escapes by itself (AUTOESCAPE): values go in as they are.
#pragma once

// ctemplate's headers use strlen without its header: so that one comes first.
// clang-format off
#include <cstring>
#include <ctemplate/template_dictionary.h>
// clang-format on

#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal::report {

using Dictionary = ctemplate::TemplateDictionary;

// "revision.tpl", ... with the dictionary's values. Thread-safe.
[[nodiscard]] Result<std::string> Expand(const std::string& template_name, const Dictionary& values);

// The <head> of a page: `root` is the relative path to the folder that holds style.css ("" or "../../").
void FillHead(Dictionary& page, const std::string& title, const std::string& root);
// A script at the end of the page; `path` is relative to the page.
void AddScript(Dictionary& page, const std::string& path);
// Scripts that run one after the other once the page has shown its first content; `later` is the path of later.js.
void AddScriptsLater(Dictionary& page, const std::string& later, const std::vector<std::string>& paths);
// {{#section}} with one value in it.
void ShowValue(Dictionary& parent, const char* section, const char* variable, const std::string& value);

}  // namespace rigcal::report
