#ifndef TESSERA_MEDIATOR_SHADING_WHITTED_H
#define TESSERA_MEDIATOR_SHADING_WHITTED_H

#include "mediator/shading/transport.h"

// Perfect speculars followed through both branches (Whitted 1980).
SHADING_BEGIN

inline constexpr uint MaxSpecularDepth = 8u;
// A branch that carries less than half a step of an 8-bit picture is not followed.
inline constexpr float MinBranchWeight = 1.0f / 512.0f;

struct Branch {
    Ray ray;
    vec3 weight;        // of what is seen along it
    float probability;  // with which a path that chooses one lobe at a time would come here
    uint node;          // in the tree of branches, breadth first: 0, then 2 node + 1 and 2 node + 2
    uint depth;
};

// Branches still to follow: depth first, so one sibling per level at most.
struct BranchStack {
    Branch branches[MaxSpecularDepth + 1u];
    uint count;
};

inline void push_branch(INOUT(BranchStack) open, IN(Branch) parent, IN(Surface) surface, vec3 share,
                        float probability, vec3 direction, uint child) {
    const vec3 weight = parent.weight * share;
    if (!(largest(weight) >= MinBranchWeight)) return;
    open.branches[open.count] = Branch(leaving(surface, direction), weight, parent.probability * probability,
                                       2u * parent.node + child, parent.depth + 1u);
    open.count += 1u;
}

inline void push_children(INOUT(BranchStack) open, IN(Branch) parent, IN(Surface) surface) {
    if (surface.rough_share == 1.0f || parent.depth == MaxSpecularDepth) return;
    const LobeChances chances = lobe_chances(surface);
    push_branch(open, parent, surface, surface.specular.reflection, chances.reflection,
                surface.specular.reflected, 1u);
    push_branch(open, parent, surface, surface.specular.refraction, chances.refraction,
                surface.specular.refracted, 2u);
}

// Head light and unoccluded ambient light (Schwenk 2A.3), in [0, 1] for albedos in [0, 1]:
// sum over branches of weight x albedo / 2 x (1 + max(0, n . -d)); nothing where a branch leaves the scene.
inline vec3 range_at(IN(Branch) branch, IN(Surface) surface) {
    const float facing = -dot(surface.frame[2], branch.ray.direction);
    return branch.weight * surface.albedo * (surface.rough_share * 0.5f * (1.0f + greater_of(facing, 0.0f)));
}

inline void enter_branch(INOUT(Path) path, IN(Branch) branch) {
    path.vertex = branch.node;
    path.throughput = branch.weight;
    path.probability = branch.probability;
    path.bsdf_pdf = 0.0f;
    path.way = direct_way();
}

// Direct light, as path tracing finds it with max_bounces = 0.
WITH_CONTEXT inline void gather_direct(IN(Context) context, INOUT(Path) path, IN(Branch) branch,
                                       IN(Surface) surface) {
    const vec3 wo = to_local(surface, -branch.ray.direction);
    add_lights(context, path, surface, wo);
    Ray ray = branch.ray;
    if (!scatter(context.view, path, surface, wo, rough_lobe(path), ray)) return;
    path.vertex += 1u;
    path.rays += 1u;
    Hit hit;
    if (trace_closest(context, ray, closest_seed(path), hit)) {
        add_emission(context, path, ray, make_surface(context.scene, hit, ray.direction));
    } else {
        add_sky(context, path, ray);
    }
}

// Emission, and direct light of what is not perfect specular; its features by the branches' weights, the
// normal by their probabilities.
WITH_CONTEXT inline void light_branch(IN(Context) context, INOUT(Path) path, IN(Branch) branch,
                                      IN(Surface) surface) {
    enter_branch(path, branch);
    add_emission(context, path, branch.ray, surface);
    if (!(surface.rough_share > 0.0f)) return;
    path.probability *= lobe_chances(surface).rough;
    path.found.albedo += branch.weight * surface.albedo * surface.rough_share;
    path.found.normal += path.probability * surface.frame[2];
    if (surface.scatters) gather_direct(context, path, branch, surface);
}

// What to find along the branches, either or both for the same rays.
inline constexpr uint FindRange = 1u, FindLight = 2u;

// From a first hit that is already known; traces no ray where that is no perfect specular. What it finds is
// the path's; of its state only the rays count afterwards.
WITH_CONTEXT inline void follow_speculars(IN(Context) context, INOUT(Path) path, IN(Ray) camera_ray,
                                          IN(Surface) first, uint what) {
    BranchStack open;
    open.count = 0u;
    Branch branch = Branch(camera_ray, vec3(1.0f), 1.0f, 0u, 0u);
    Surface surface = first;
    bool is_hit = true;
    while (true) {
        if (is_hit) {
            if ((what & FindLight) != 0u) light_branch(context, path, branch, surface);
            if ((what & FindRange) != 0u) path.found.range += range_at(branch, surface);
            push_children(open, branch, surface);
        } else if ((what & FindLight) != 0u) {
            enter_branch(path, branch);
            add_sky(context, path, branch.ray);
        }
        if (open.count == 0u) return;
        open.count -= 1u;
        branch = open.branches[open.count];
        path.vertex = branch.node;
        path.rays += 1u;
        Hit hit;
        is_hit = trace_closest(context, branch.ray, closest_seed(path), hit);
        if (is_hit) surface = make_surface(context.scene, hit, branch.ray.direction);
    }
}

SHADING_END

#endif
