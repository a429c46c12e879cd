#pragma once

#include <span>
#include <string>

#include "master/scene/transaction.h"

namespace tessera::master {

// The name of an object in logs and notes: "materials/red", or "materials/@17" without a name. Long names are cut,
// control characters replaced.
std::string object_path(ObjectId id, const scene::Object& object);

// A one-line summary: "set materials/red base_color", "created 12 objects, removed 3".
std::string summary(std::span<const scene::ObjectChange> changes);

std::string summary(const Transaction& transaction);

// Untrusted text made safe for display: without control characters, cut at `limit` bytes.
std::string shown(const std::string& text, std::size_t limit);

}  // namespace tessera::master
