#version 460
#extension GL_GOOGLE_include_directive : require

// All functions of one of the lists; LIST as in evaluation.h.
#include "tests/shading/scene_puts.h"

layout(local_size_x = 64) in;

ARRAY_OF(Inputs, InputArray, 4);
layout(buffer_reference, scalar) writeonly buffer OutputArray { Outputs items[]; };

layout(push_constant, scalar) uniform Arguments {
    TestScene test_scene;
    InputArray inputs;
    OutputArray outputs;
    uint count;
};

#define FUNCTION(ordinary, edges, call)       \
    {                                         \
        Outputs y = no_outputs();             \
        put(y, call);                         \
        outputs.items[place * count + i] = y; \
        place += 1u;                          \
    }
#define DECIDES(ordinary, edges, call) FUNCTION(ordinary, edges, call)

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    const Inputs x = inputs.items[i];
    uint place = 0u;
    Case c = make_case(test_scene, x);  // left out where it is not used
#if LIST == 0
#include "tests/shading/functions/numbers.inc"
#elif LIST == 1
#include "tests/shading/functions/lobes.inc"
#elif LIST == 2
#include "tests/shading/functions/textures.inc"
#elif LIST == 3
#include "tests/shading/functions/surfaces.inc"
#elif LIST == 4
#include "tests/shading/functions/lights.inc"
#elif LIST == 5
#include "tests/shading/functions/found.inc"
#elif LIST == 6
#include "tests/shading/functions/steps.inc"
#elif LIST == 7
#include "tests/shading/functions/branches.inc"
#elif LIST == 8
#include "tests/shading/functions/samples.inc"
#elif LIST == 9
#include "tests/shading/functions/surface_shaders.inc"
#elif LIST == 10
#include "tests/shading/functions/views.inc"
#elif LIST == 11
#include "tests/shading/functions/materials.inc"
#elif LIST == 12
#include "tests/shading/functions/media.inc"
#endif
}
