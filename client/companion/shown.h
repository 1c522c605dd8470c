// What the page and its document show now, handed from the one thread that looks to the threads that answer.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "client/companion/standing.h"
#include "server/http/server.h"

namespace rigcal::companion {

class Shown {
 public:
  // Until Show(): that the folder is being read.
  explicit Shown(std::filesystem::path folder);
  // From now on this is answered. Any thread.
  void Show(const Standing& standing);
  // There is no session: the sentence stands in place of the advice.
  void ShowTrouble(const Error& error);
  // "/", its style and script, "/api/v1/companion", "/pictures/<sensor>/<file>" of pictures that the document names;
  // http::Answer, from any thread. Nothing else of the folder is given away.
  [[nodiscard]] Result<http::Page> Answer(const std::string& path) const;

 private:
  struct Document {
    std::string json;
    std::set<std::string> pictures;  // paths in the folder
  };
  void Put(Document document);
  [[nodiscard]] std::shared_ptr<const Document> Now() const;

  std::filesystem::path folder_;
  mutable std::mutex mutex_;  // guards what follows
  std::shared_ptr<const Document> now_;
};

}  // namespace rigcal::companion
