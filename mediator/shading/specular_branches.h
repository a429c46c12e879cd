#ifndef TESSERA_MEDIATOR_SHADING_SPECULAR_BRANCHES_H
#define TESSERA_MEDIATOR_SHADING_SPECULAR_BRANCHES_H

#include "mediator/shading/medium_traversal.h"

// Follows reflection and refraction of perfect speculars as a tree of branches (Whitted 1980).
SHADING_BEGIN

inline constexpr uint MaxSpecularDepth = 8u;
// Branches with less weight than half a level of an 8-bit picture are not followed.
inline constexpr float MinBranchWeight = 1.0f / 512.0f;

struct Branch {
    Ray ray;
    RayCone cone;
    vec3 weight;        // of the light along it
    float probability;  // with which a path that samples one lobe at a time would get here
    uint node;          // in the tree of branches, breadth first: 0, then 2 node + 1 and 2 node + 2
    uint depth;
    SpecularChain chain;
    uvec4 containing_media;
    MediumTraversal traversal;  // of its ray
    bool passes;                // the rest of a branch whose medium has been handled
    bool first;                 // nothing has been hit yet
};

// Branches still to follow: depth first, so at most one sibling per level.
struct BranchStack {
    Branch branches[MaxSpecularDepth + 1u];
    uint count;
};

inline Branch root_branch(IN(Ray) camera_ray, IN(RayCone) cone) {
    return Branch(camera_ray, cone, vec3(1.0f), 1.0f, 0u, 0u, SpecularChain(false, -1), no_media(),
                  new_traversal(camera_ray.origin), false, true);
}

// `cone`, `containing_media`: of the parent at the surface; `channel`: the colour channel that is followed on
// dispersion.
inline void push_children(INOUT(BranchStack) stack, IN(Scene) scene, IN(Branch) parent, IN(RayCone) cone,
                          uvec4 containing_media, IN(Surface) surface, uint channel) {
    if (surface.rough_fraction == 1.0f || parent.depth == MaxSpecularDepth) return;
    const LobeChances chances = lobe_chances(surface);
    for (uint child = 1u; child <= 2u; ++child) {
        const bool reflects = child == 1u;
        Refraction next = Refraction(surface.specular.reflection, surface.specular.reflected);
        SpecularChain chain = SpecularChain(parent.chain.is_single_channel, surface.environment);
        if (!reflects) {
            next = refraction_of(surface.specular, channel, chain.is_single_channel);
            chain.is_single_channel = chain.is_single_channel || surface.specular.splits;
        }
        const vec3 weight = parent.weight * next.weight;
        if (!(largest(weight) >= MinBranchWeight)) continue;
        const float probability = parent.probability * (reflects ? chances.reflection : chances.refraction);
        const Ray ray = leaving(surface, next.direction);
        stack.branches[stack.count] =
            Branch(ray, cone, weight, probability, 2u * parent.node + child, parent.depth + 1u, chain,
                   media_after(scene, containing_media, surface, next.direction), new_traversal(ray.origin),
                   false, false);
        stack.count += 1u;
    }
}

// Pushes the rest of a branch, behind the point in a medium where it scatters. The stack has space, since the
// branch has no children yet.
inline void push_rest(INOUT(BranchStack) stack, IN(Branch) branch, IN(Path) path, IN(Ray) ray,
                      IN(MediumTraversal) traversal, bool first) {
    Branch rest = branch;
    rest.ray = ray;
    rest.cone = path.cone;
    rest.weight = path.throughput;
    rest.containing_media = path.containing_media;
    rest.passes = true;
    rest.traversal = traversal;
    rest.first = first;
    stack.branches[stack.count] = rest;
    stack.count += 1u;
}

inline void path_from_branch(INOUT(Path) path, IN(Branch) branch) {
    path.vertex = branch.node;
    path.throughput = branch.weight;
    path.probability = branch.probability;
    path.bsdf_pdf = 0.0f;
    path.cone = branch.cone;
    path.chain = branch.chain;
    path.containing_media = branch.containing_media;
    path.class_info = direct_class_info();
}

// Head light and unoccluded ambient light (Schwenk 2A.3), in [0, 1] for albedos in [0, 1]:
// sum over branches of weight x albedo / 2 x (1 + max(0, n . -d)); nothing where a branch leaves the scene.
inline vec3 headlight_at(IN(Branch) branch, IN(Surface) surface) {
    const float facing = -dot(surface.frame[2], branch.ray.direction);
    return branch.weight * surface.albedo *
           (surface.rough_fraction * 0.5f * (1.0f + greater_of(facing, 0.0f)));
}

SHADING_END

#endif
