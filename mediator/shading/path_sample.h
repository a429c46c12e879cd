#ifndef TESSERA_MEDIATOR_SHADING_PATH_SAMPLE_H
#define TESSERA_MEDIATOR_SHADING_PATH_SAMPLE_H

#include "mediator/shading/records.h"

RECORDS_BEGIN

// What one sample found. Radiance is low + high, so that its bits do not depend on the channels asked for.
struct PathSample {
    vec3 low;           // light outside
    vec3 high;          // and inside of the view's path class
    vec3 diffuse;       // of it, by the diffuse lobe of the first non-delta hit; where needed
    float connections;  // grey intensity of the lights that were reached; where needed
    vec3 albedo;        // of the first non-delta hit times the weight of the way to it
    vec3 normal;        // of the first non-delta hit
    vec3 range;         // head light and ambient (Schwenk 2A.3); where asked for
    float depth;        // of the first hit, along the view axis; infinite: nothing hit
    uint object;        // id of the first hit
    float alpha;        // 1 where the camera sees something, else the background's
};

RECORDS_END

#endif
