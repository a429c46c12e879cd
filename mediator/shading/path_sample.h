#ifndef TESSERA_MEDIATOR_SHADING_PATH_SAMPLE_H
#define TESSERA_MEDIATOR_SHADING_PATH_SAMPLE_H

#include "mediator/shading/records.h"

RECORDS_BEGIN

// The result of one sample. Radiance is low + high, so that its bits do not depend on the channels requested.
struct PathSample {
    vec3 low;           // light outside of
    vec3 high;          // and inside the view's path class
    vec3 diffuse;       // part by the diffuse lobe of the first non-delta hit; if needed
    float connections;  // grey intensity of the lights that were reached; if needed
    vec3 albedo;        // of the first non-delta hit, times the throughput up to it
    vec3 normal;        // of the first non-delta hit
    vec3 headlight;     // headlight and ambient (Schwenk 2A.3); if requested
    float depth;        // of the first hit, along the view axis; infinite: nothing hit
    uint object;        // id of the first hit
    float alpha;        // 1 if the camera ray hits something, else the background's
};

RECORDS_END

#endif
