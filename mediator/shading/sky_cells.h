#ifndef TESSERA_MEDIATOR_SHADING_SKY_CELLS_H
#define TESSERA_MEDIATOR_SHADING_SKY_CELLS_H

#include "mediator/shading/cdf.h"
#include "mediator/shading/maths.h"
#include "mediator/shading/records.h"

// Where sky and suns are seen from, by region: in rooms most of it is hidden by walls, and light samples in proportion to its
// luminance alone miss the windows. A cell holds a distribution over tiles of the sphere, in proportion to what arrives
// from each through its surfaces (as Atanasov et al. 2018). What a cell does not know costs noise, never bias: MIS
// weights use the densities of the mixture. mediator/backend/sky_cells.h makes them.
SHADING_BEGIN

// Tiles of equal solid angle: columns by azimuth around z, rows by z.
inline constexpr uint SkyColumns = 32u, SkyRows = 16u, SkyTiles = SkyColumns * SkyRows;
inline constexpr float SkyTileSolidAngle = 4.0f * Pi / float(SkyTiles);
// One k-d tree for each direction that surfaces face most, and one for surfaces that receive light from both sides.
inline constexpr uint SkyFaces = 7u, SkyFaceBoth = 6u;
inline constexpr uint SkyLeaf = 3u;  // axis of nodes without children
inline constexpr uint MaxSkyDepth = 32u;

inline uint sky_face_of(vec3 normal) {
    const vec3 size = abs(normal);
    if (normal == vec3(0.0f)) return SkyFaceBoth;
    if (size.x >= size.y && size.x >= size.z) return normal.x > 0.0f ? 0u : 1u;
    if (size.y >= size.z) return normal.y > 0.0f ? 2u : 3u;
    return normal.z > 0.0f ? 4u : 5u;
}

// Index of the cell of a surface point; NoSkyCell: none, or the sample does not use them. `normal`: a receiver's
// (light_tree.h).
inline uint sky_cell_at(IN(View) view, uint sample_index, vec3 place, vec3 normal) {
    if (view.sky_cells_from == NoSkyCells || sample_index < view.sky_cells_from) return NoSkyCell;
    uint index = sky_face_of(normal);
    NO_UNROLL
    for (uint depth = 0u; depth < MaxSkyDepth; ++depth) {
        const SkyNode node = view.sky_nodes.items[index];
        if (node.axis == SkyLeaf) return node.child;
        const float along = node.axis == 0u ? place.x : (node.axis == 1u ? place.y : place.z);
        index = node.child + (along < node.split ? 0u : 1u);
    }
    return NoSkyCell;
}

inline uint sky_tile_of(vec3 direction) {
    const float azimuth = arc_tangent(direction.y, direction.x) * (0.5f * InversePi);
    const uint column = min(uint((azimuth - floor(azimuth)) * float(SkyColumns)), SkyColumns - 1u);
    const float height = clamp(0.5f + 0.5f * direction.z, 0.0f, 1.0f);
    return min(uint(height * float(SkyRows)), SkyRows - 1u) * SkyColumns + column;
}

// A direction in a tile, of unit length; u in [0, 1)^2.
inline vec3 direction_in_tile(uint tile, vec2 u) {
    const float azimuth = (2.0f * Pi / float(SkyColumns)) * (float(tile % SkyColumns) + u.x);
    // By the height in [0, 1], so that the radius does not cancel near the poles.
    const float height = (float(tile / SkyColumns) + u.y) * (1.0f / float(SkyRows));
    const float z = 2.0f * height - 1.0f, radius = 2.0f * sqrt(greater_of(height * (1.0f - height), 0.0f));
    return vec3(radius * cosine(azimuth), radius * sine(azimuth), z);
}

// Density per solid angle with which light samples of the sky find a direction; `map_pdf`: of samples of the map.
inline float sky_cell_pdf(IN(View) view, uint index, vec3 direction, float map_pdf) {
    if (index == NoSkyCell) return map_pdf;
    const SkyCell cell = view.sky_cells.items[index];
    const float tile = probability_of(view.sky_cdfs, cell.cdf, sky_tile_of(direction));
    return mix(map_pdf, tile * (1.0f / SkyTileSolidAngle), cell.tile_chance);
}

SHADING_END

#endif
