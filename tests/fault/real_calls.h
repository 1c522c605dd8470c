// The function that a replaced one stands for.
#pragma once

#include <dlfcn.h>

namespace rigcal::fault {

template <typename Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace rigcal::fault
