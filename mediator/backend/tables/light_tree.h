#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "mediator/shading/records.h"

namespace tessera::backend {

// An emitter as a leaf of the light tree.
struct LightLeaf {
    glm::dvec3 low, high;       // bounds
    glm::dvec3 axis{0.0};       // of the cone of directions that it faces; of unit length
    double spread = 0.0;        // half angle of that cone; pi: all directions, whatever the axis
    double reach = 0.0;         // angle to which it shines around each of them
    double power = 0.0;         // finite, more than 0
    std::uint32_t emitter = 0;  // index
    bool shaped = false;        // a sphere or a quad: rays look for it
    bool two_sided = false;     // shines along -axis, too
};

// The nodes of a light tree (mediator/shading/light_tree.h), and in `emitters` the leaf of each emitter and
// in the leaf the emitter. A pure function of the leaves and their order. About n log n: 10,000 leaves in 4
// ms, a million in 0.9 s.
std::vector<shading::LightNode> make_light_tree(std::span<const LightLeaf> leaves,
                                                std::span<shading::Emitter> emitters);

}  // namespace tessera::backend
