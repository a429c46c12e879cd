#ifndef TESSERA_MEDIATOR_SHADING_THIN_WALLS_H
#define TESSERA_MEDIATOR_SHADING_THIN_WALLS_H

#include "mediator/shading/maths.h"
#include "mediator/shading/rays.h"

// Thin walls (is_thin_wall) that a ray to a light has met. The light is attenuated by them without tracing a ray from wall to
// wall. Up to two are kept, found in any order, which acceleration structures do not promise.
RECORDS_BEGIN

struct ThinWalls {
    uint count;  // UnknownThinWalls: more than are kept, or at least one where none is kept
    Hit first;
    Hit second;
};

inline constexpr uint MaxThinWalls = 2u, UnknownThinWalls = 3u;

// In shaders a second place that evaluates materials would double the time that drivers take to compile.
#ifdef __cplusplus
inline constexpr bool KeepsThinWalls = true;
#else
const bool KeepsThinWalls = false;
#endif

RECORDS_END

SHADING_BEGIN

inline ThinWalls no_thin_walls() {
    const Hit none = Hit(NoInstance, 0u, vec2(0.0f), 0.0f);
    return ThinWalls(0u, none, none);
}

// At least one, of which nothing is known but that light may pass.
inline ThinWalls unknown_thin_walls() {
    ThinWalls walls = no_thin_walls();
    walls.count = UnknownThinWalls;
    return walls;
}

// Whether two walls are so close to each other that they may be one, hit at an edge of its triangles. A ray that is traced from
// wall to wall meets only one of them. Distances differ by their rounding, which is far smaller.
inline bool may_be_one_wall(IN(Hit) a, IN(Hit) b) {
    return abs(a.distance - b.distance) <= (1.0f / 4096.0f) * greater_of(a.distance, b.distance);
}

// The order of the calls does not matter. Acceleration structures may find a triangle more than once.
inline void meet_thin_wall(INOUT(ThinWalls) walls, IN(Hit) hit) {
    if (walls.count == UnknownThinWalls) return;
    if (walls.count == 0u) {
        walls.first = hit;
        walls.count = 1u;
        return;
    }
    if (hit.instance == walls.first.instance && hit.triangle == walls.first.triangle) return;
    if (walls.count == 2u) {
        const bool is_known = hit.instance == walls.second.instance && hit.triangle == walls.second.triangle;
        if (!is_known) walls.count = UnknownThinWalls;
        return;
    }
    walls.second = hit;
    walls.count = may_be_one_wall(walls.first, hit) ? UnknownThinWalls : 2u;
}

SHADING_END

#endif
