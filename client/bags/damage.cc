#include "client/bags/bag.h"
#include "client/bags/limits.h"

namespace rigcal::bags {

void Damage::Add(Error error) {
  if (told_.size() < limits::kDamageToldMax)
    told_.push_back(std::move(error));
  else
    ++more_;
}

void Damage::Add(const Damage& other) {
  for (const Error& error : other.told_) Add(error);
  more_ += other.more_;
}

std::vector<Error> Damage::All() const {
  std::vector<Error> all = told_;
  if (more_ > 0)
    all.push_back({ErrorCode::kInvalidInput, std::to_string(more_) + " more places could not be read",
                   "Record the bag again, or repair it where it was recorded."});
  return all;
}

}  // namespace rigcal::bags
