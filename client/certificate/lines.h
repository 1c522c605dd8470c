// A certificate as lines of text, from the server's documents.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "client/text/document.h"

namespace rigcal::client {

struct CertificateDocuments {
  Document show;                   // of the revision
  std::string software;            // version of the server
  std::vector<Document> sessions;  // answers of `session` that the revision counts, the newest first
};

enum class LineStyle { kTitle, kHeading, kText, kTable };
struct CertificateLine {
  std::string text;
  LineStyle style = LineStyle::kText;
};
inline constexpr std::size_t kTextColumns = 116;  // of kText: longer ones are wrapped

// Fits one page (paper.h): of many sensors and sessions it has the least certain and the newest, and says how many more
// there are. What is not approved, or no more, gives a record that is called no certificate and has no place to sign.
[[nodiscard]] std::vector<CertificateLine> CertificateLines(const CertificateDocuments& documents);
// Of a document of `show`, by their edges that count; the newest are not known before they are asked for.
[[nodiscard]] std::vector<std::string> SessionsCounted(const Document& show);

// Parts of it. Text in lines of at most kTextColumns, further ones indented; `lines_max`: what is beyond ends in
// "[...]".
void AddText(const std::string& text, std::size_t lines_max, std::vector<CertificateLine>& lines);
void AddPoses(const Document& show, std::vector<CertificateLine>& lines);
void AddAsFound(const Document& show, std::vector<CertificateLine>& lines);
void AddMeasuredWith(const CertificateDocuments& documents, std::vector<CertificateLine>& lines);

enum class Decision { kWithin, kOpen, kBeyond };
// Of |d| and U against a tolerance: README.md.
[[nodiscard]] Decision Decide(double off, double U, double tolerance);

}  // namespace rigcal::client
