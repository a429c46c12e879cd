#include "tests/shading/evaluation.h"

#include "tests/shading/scene_puts.h"

// CMakeLists.txt compiles this file twice, the second time with other names for this function and the
// functions it calls, so that the linker keeps both.
#ifndef EVALUATE
#define EVALUATE evaluate_plain
#endif

#define FUNCTION(ordinary, edges, call) \
    *y = no_outputs();                  \
    put(*y, call);                      \
    y += count;
#define DECIDES FUNCTION

namespace tessera {

namespace shading {
namespace {

void numbers([[maybe_unused]] const Case& c, const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/numbers.inc"
}
void lobes([[maybe_unused]] const Case& c, const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/lobes.inc"
}
void textures([[maybe_unused]] const Case& c, const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/textures.inc"
}
void surfaces([[maybe_unused]] const Case& c, const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/surfaces.inc"
}
void lights([[maybe_unused]] const Case& c, const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/lights.inc"
}
void found(const Case& c, [[maybe_unused]] const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/found.inc"
}
void steps(const Case& c, [[maybe_unused]] const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/steps.inc"
}
void branches(const Case& c, [[maybe_unused]] const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/branches.inc"
}
void samples(const Case& c, [[maybe_unused]] const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/samples.inc"
}
void surface_shaders(const Case& c, const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/surface_shaders.inc"
}
void materials([[maybe_unused]] const Case& c, [[maybe_unused]] const Inputs& x, std::size_t count,
               Outputs* y) {
#include "tests/shading/functions/materials.inc"
}
void media(const Case& c, const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/media.inc"
}
void views([[maybe_unused]] const Case& c, [[maybe_unused]] const Inputs& x, std::size_t count, Outputs* y) {
#include "tests/shading/functions/views.inc"
}

using List = void(const Case& c, const Inputs& x, std::size_t count, Outputs* y);
constexpr List* Lists[FunctionListCount] = {numbers, lobes,     textures, surfaces, lights,
                                            found,   steps,     branches, samples,  surface_shaders,
                                            views,   materials, media};

}  // namespace
}  // namespace shading

void EVALUATE(std::uint32_t list, const void* test_scene, const void* inputs, std::size_t count,
              void* outputs) {
    const auto& place = *static_cast<const shading::TestScene*>(test_scene);
    const auto* x = static_cast<const shading::Inputs*>(inputs);
    auto* y = static_cast<shading::Outputs*>(outputs);
    for (std::size_t i = 0; i < count; ++i) {
        shading::Lists[list](shading::make_case(place, x[i]), x[i], count, y + i);
    }
}

}  // namespace tessera
