#pragma once

#include <vector>

#include "tests/shading/generator.h"
#include "tests/shading/test_scene.h"

// Materials of the test scene (test_scene_builder.h), of every kind.
namespace tessera::shading {

inline constexpr uint TestMaterials = 8;  // one for each instance

// Of the texture with this index, -1 = none, turned, scaled and shifted.
TextureUse texture_use(int texture, Generator& random);

std::vector<Material> make_test_materials(Generator& random);

// With and without perfect lobes, normal and height maps, own tangent frames.
std::vector<SurfaceShaderParams> make_test_shaders(Generator& random);

// Those of every other material, each with different lobes.
std::vector<MaterialExtras> make_test_extras(Generator& random);

}  // namespace tessera::shading
