#ifndef TESSERA_MEDIATOR_SHADING_BVH_LAYOUT_H
#define TESSERA_MEDIATOR_SHADING_BVH_LAYOUT_H

#include "mediator/shading/language.h"

// The acceleration structure in memory: one pool of 16-byte items that holds the nodes, triangles and
// instances of two levels. After Ylitie, Karras and Laine (2017): nodes of up to 8 children whose boxes are
// quantised to 8 bits an axis in a frame of the node; unlike there, children are visited in order of their
// distance, and so the inner ones come first and have no octant.
SHADING_BEGIN

inline constexpr uint BvhWidth = 8u;          // children of a node
inline constexpr uint BvhLeafTriangles = 3u;  // of one child; 8 children fill the 24 bits of a mask
inline constexpr uint BvhNodeItems = 5u;
inline constexpr uint BvhTriangleItems = 3u;
inline constexpr uint BvhInstanceItems = 5u;  // as many as a node, since both are in one array of children

// Maximum depths. A visited node leaves at most one entry on the stack, an entered instance one more; the
// entry above the last one is written as well.
inline constexpr uint BvhTopDepth = 12u;
inline constexpr uint BvhMeshDepth = 18u;
inline constexpr uint BvhStackSize = 32u;

// The nodes of a mesh are one contiguous array, the root first, every node before its children; likewise its
// triangles. Indices are relative to these arrays, so that a tree is relocatable. In the top level the
// children after the inner ones are instances in the same array.
struct BvhNode {
    vec3 origin;  // of the frame, at or below all boxes
    uint frame;   // three biased exponents, x lowest: a step is 2^(e - 127); highest byte: count of inner
                  // children
    uint first_child;     // its children are contiguous, in units of BvhNodeItems
    uint first_triangle;  // in its array; top level: count of instances, the children after the inner ones
    uvec2 leaves;         // a byte each child: 5 bits first triangle from first_triangle, 3 bits one for each
                          // triangle; 0 = no leaf. Top level: 0
    uvec2 low_x, low_y, low_z;     // a byte each child, lowest first; in steps from the origin
    uvec2 high_x, high_y, high_z;  // no child: 255 and 0
};

struct BvhTriangle {
    vec3 a;
    uint triangle;  // index in the mesh
    vec3 b;
    uint unused0;
    vec3 c;
    uint unused1;
};

struct BvhInstance {
    vec4 object_x, object_y, object_z;  // rows of object from world
    uint nodes, triangles;              // where the mesh's arrays start, in items of the pool
    uint instance;                      // index in the scene
    uint flags;                         // BvhAlphaTested, BvhMoves
    uint layers;                        // rays with none of these layers skip it
    // Of BvhMoves only. Where its transforms start, in items from the top level's root: BvhTransformItems per
    // motion key, rows of world from object; and the number of keys - 1. If 0, object_x to object_z apply.
    uint transform_keys;
    uint key_intervals;
    uint mesh_key_intervals;  // motion keys of its triangles - 1; a triangle has BvhTriangleItems per key
};

inline constexpr uint BvhAlphaTested = 2u;  // hits need the alpha test
inline constexpr uint BvhMoves = 4u;        // it or its vertices move while the shutter is open
inline constexpr uint BvhTransformItems = 3u;

#ifdef __cplusplus

static_assert(sizeof(BvhNode) == 16 * BvhNodeItems);
static_assert(offsetof(BvhNode, origin) == 0 && offsetof(BvhNode, frame) == 12);
static_assert(offsetof(BvhNode, first_child) == 16 && offsetof(BvhNode, first_triangle) == 20);
static_assert(offsetof(BvhNode, leaves) == 24);
static_assert(offsetof(BvhNode, low_x) == 32 && offsetof(BvhNode, low_y) == 40);
static_assert(offsetof(BvhNode, low_z) == 48 && offsetof(BvhNode, high_x) == 56);
static_assert(offsetof(BvhNode, high_y) == 64 && offsetof(BvhNode, high_z) == 72);
static_assert(sizeof(BvhTriangle) == 16 * BvhTriangleItems);
static_assert(offsetof(BvhTriangle, a) == 0 && offsetof(BvhTriangle, triangle) == 12);
static_assert(offsetof(BvhTriangle, b) == 16 && offsetof(BvhTriangle, unused0) == 28);
static_assert(offsetof(BvhTriangle, c) == 32 && offsetof(BvhTriangle, unused1) == 44);
static_assert(sizeof(BvhInstance) == 16 * BvhInstanceItems);
static_assert(offsetof(BvhInstance, object_x) == 0 && offsetof(BvhInstance, object_y) == 16);
static_assert(offsetof(BvhInstance, object_z) == 32);
static_assert(offsetof(BvhInstance, nodes) == 48 && offsetof(BvhInstance, triangles) == 52);
static_assert(offsetof(BvhInstance, instance) == 56 && offsetof(BvhInstance, flags) == 60);
static_assert(offsetof(BvhInstance, layers) == 64 && offsetof(BvhInstance, transform_keys) == 68);
static_assert(offsetof(BvhInstance, key_intervals) == 72 && offsetof(BvhInstance, mesh_key_intervals) == 76);
static_assert(BvhStackSize >= BvhTopDepth + BvhMeshDepth + 2);

#endif

SHADING_END

#endif
