#include "server/report/choices.h"

#include <algorithm>

namespace rigcal::report {

void FillChoices(Dictionary& parent, const char* section, std::vector<int> numbers, int chosen) {
  constexpr std::size_t kChoicesMax = 500;
  std::sort(numbers.rbegin(), numbers.rend());
  numbers.resize(std::min(numbers.size(), kChoicesMax));
  if (std::find(numbers.begin(), numbers.end(), chosen) == numbers.end()) numbers.push_back(chosen);
  for (const int number : numbers) {
    Dictionary* option = parent.AddSectionDictionary(section);
    option->SetValue("NUMBER", std::to_string(number));
    if (number == chosen) option->ShowSection("CHOSEN");
  }
}

}  // namespace rigcal::report
