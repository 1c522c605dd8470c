#include "client/named.h"

namespace rigcal::client {

const CLI::Validator& Named() {
  static const CLI::Validator named(
      [](std::string& name) {
        return name.find_first_not_of(" \t") == std::string::npos
                   ? std::string("needs a name: say who you are, or leave the option out")
                   : std::string();
      },
      "");
  return named;
}

}  // namespace rigcal::client
