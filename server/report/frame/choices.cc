#include "server/report/frame/choices.h"

#include <algorithm>
#include <vector>

namespace rigcal::report {

void FillChoices(Dictionary& parent, const char* section, int newest, int chosen) {
  constexpr int kChoicesMax = 500;
  std::vector<int> numbers;
  for (int number = newest; number > std::max(newest - kChoicesMax, 0); --number) numbers.push_back(number);
  if (std::find(numbers.begin(), numbers.end(), chosen) == numbers.end()) numbers.push_back(chosen);
  for (const int number : numbers) {
    Dictionary* option = parent.AddSectionDictionary(section);
    option->SetValue("NUMBER", std::to_string(number));
    if (number == chosen) option->ShowSection("CHOSEN");
  }
}

}  // namespace rigcal::report
