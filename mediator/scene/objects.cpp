#include "mediator/scene/objects.h"

#include <array>

namespace tessera::scene {

const char* name(ObjectKind kind) {
    static constexpr std::array Names{"root",       "transform",      "geometry", "material",
                                      "texture",    "light",          "camera",   "background",
                                      "attachment", "surface_shader", "medium"};
    static_assert(Names.size() == std::variant_size_v<Object>);
    return Names[static_cast<std::size_t>(kind)];
}

const std::string& name(const Object& object) {
    return std::visit([](const auto& value) -> const std::string& { return value.name; }, object);
}

}  // namespace tessera::scene
