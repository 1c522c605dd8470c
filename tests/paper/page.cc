#include "tests/paper/page.h"

namespace rigcal::paper {
namespace {

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>The paper's experiments</title><style>
:root { color-scheme: light dark; --text: #1c2330; --back: #fff; --line: #d7dce3; }
@media (prefers-color-scheme: dark) { :root { --text: #dfe4ec; --back: #14181f; --line: #364050; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--back); max-width: 60rem;
  margin: 2rem auto; padding: 0 1rem; }
figure { margin: 1rem 0; overflow-x: auto; } svg { max-width: 100%; height: auto; }
svg text { font: 12px system-ui, sans-serif; fill: var(--text); } svg .grid { stroke: var(--line); }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
td, th { padding: .25rem .8rem; border-bottom: 1px solid var(--line); text-align: right; } th { text-align: left; }
</style></head><body>
<h1>The paper's experiments</h1>
<p>Chen and Schwertfeger, <i>Heterogeneous Multi-sensor Calibration based on Graph Optimization</i> (RCAR 2019), done again on simulated
truth.</p>
)";

}  // namespace

std::string Page(const std::vector<std::string>& sections) {
  std::string page = kHead;
  for (const std::string& section : sections) page += section;
  return page + "</body></html>\n";
}

}  // namespace rigcal::paper
