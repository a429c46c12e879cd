// Push constants of both shader stages, as struct DrawJob in raster_jobs.h.
#include "mediator/shading/materials.h"
#include "mediator/shading/raster.h"

ARRAY_OF(Scene, SceneArray, 8);
ARRAY_OF(View, ViewArray, 8);
layout(push_constant, scalar) uniform Arguments {
    SceneArray scene;
    ViewArray view;
    uint64_t index;  // of the sample
    RasterCell cell;
    uint before;  // draws of the list before this call
}
job;
