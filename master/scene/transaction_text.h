#pragma once

#include <span>
#include <string>

#include "master/scene/transaction.h"

namespace tessera::master {

// "materials/red", or "materials/@17" where it has no name: how logs and notes name an object. Long names are
// cut, what a terminal would obey is replaced.
std::string object_path(ObjectId id, const scene::Object& object);

// What was done, for people, in a line: "set materials/red base_color", "created 12 objects, removed 3".
std::string summary(std::span<const scene::ObjectChange> changes);

std::string summary(const Transaction& transaction);

// Text of others, fit to be shown: without control characters, cut at `limit` bytes.
std::string shown(const std::string& text, std::size_t limit);

}  // namespace tessera::master
