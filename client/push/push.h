// The verb `push`, of folders and of bags.
#pragma once

#include <functional>

#include "client/push/push_folder.h"
#include "client/verbs.h"

namespace rigcal::client {

// Makes a session folder of the bag `options.folder` and pushes it. Bags need OpenCV's libraries, which `rigcal` is
// without: there it starts the program that has them.
using PushBag = std::function<Status(Context&, const PushOptions&)>;

// Adds `push`, with `push_bag` for what is a bag.
void AddPushWith(CLI::App& app, Context& context, PushBag push_bag);

}  // namespace rigcal::client
