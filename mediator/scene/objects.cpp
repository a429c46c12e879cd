#include "mediator/scene/objects.h"

namespace tessera::scene {

const std::string& name(const Object& object) {
    return std::visit([](const auto& value) -> const std::string& { return value.name; }, object);
}

}  // namespace tessera::scene
