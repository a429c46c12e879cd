#pragma once

#include <string>
#include <vector>

#include "mediator/scene/objects.h"

namespace tessera::scene {

// "geometry 17 ('chair')": how messages name an object.
std::string describe(ObjectId id, const Object& object);

// The problems of an object on its own: numbers that are not finite or out of range, unknown enumerators, arrays with
// inconsistent sizes. Each message names field, cause and remedy.
std::vector<std::string> causes_of(const Object& object);
// The same, prefixed with the object's description.
std::vector<std::string> problems_of(ObjectId id, const Object& object);

// "from 0 to 1", "at least 0", "finite".
std::string text_of(const Range& range);

}  // namespace tessera::scene
