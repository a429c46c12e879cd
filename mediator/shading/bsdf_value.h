#ifndef TESSERA_MEDIATOR_SHADING_BSDF_VALUE_H
#define TESSERA_MEDIATOR_SHADING_BSDF_VALUE_H

#include "mediator/shading/language.h"

SHADING_BEGIN

// The BSDF for light from wi to wo.
struct BsdfValue {
    vec3 value;    // f |cos(wi)|
    float pdf;     // of wi per solid angle, as it is sampled
    vec3 diffuse;  // the diffuse lobe's part of the value
};

SHADING_END

#endif
