#pragma once

#include <string>
#include <vector>

#include "mediator/scene/objects.h"

namespace tessera::scene {

// "geometry 17 ('chair')": how messages name an object.
std::string describe(ObjectId id, const Object& object);

// What is wrong with an object seen alone: numbers that are not finite or out of range, unknown enumerators,
// arrays whose sizes contradict each other. Messages name object, cause and remedy.
std::vector<std::string> problems_of(ObjectId id, const Object& object);

}  // namespace tessera::scene
