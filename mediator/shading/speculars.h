#ifndef TESSERA_MEDIATOR_SHADING_SPECULARS_H
#define TESSERA_MEDIATOR_SHADING_SPECULARS_H

#include "mediator/shading/courses.h"

// Perfect speculars followed through both branches (Whitted 1980).
SHADING_BEGIN

inline constexpr uint MaxSpecularDepth = 8u;
// A branch that carries less than half a step of an 8-bit picture is not followed.
inline constexpr float MinBranchWeight = 1.0f / 512.0f;

struct Branch {
    Ray ray;
    Cone cone;
    vec3 weight;        // of what is seen along it
    float probability;  // with which a path that chooses one lobe at a time would come here
    uint node;          // in the tree of branches, breadth first: 0, then 2 node + 1 and 2 node + 2
    uint depth;
    Chain chain;
    uvec4 inside;
    Course course;  // of its ray
    bool passes;    // it is the rest of a branch, whose medium has been dealt with
    bool first;     // nothing has been met yet
};

// Branches still to follow: depth first, so one sibling per level at most.
struct BranchStack {
    Branch branches[MaxSpecularDepth + 1u];
    uint count;
};

inline Branch root_branch(IN(Ray) camera_ray, IN(Cone) cone) {
    return Branch(camera_ray, cone, vec3(1.0f), 1.0f, 0u, 0u, Chain(false, -1), nowhere(),
                  new_course(camera_ray.origin), false, true);
}

// `cone`, `inside`: the parent's where it meets the surface; `channel`: that is followed where they part.
inline void push_children(INOUT(BranchStack) open, IN(Scene) scene, IN(Branch) parent, IN(Cone) cone,
                          uvec4 inside, IN(Surface) surface, uint channel) {
    if (surface.rough_share == 1.0f || parent.depth == MaxSpecularDepth) return;
    const LobeChances chances = lobe_chances(surface);
    for (uint child = 1u; child <= 2u; ++child) {
        const bool reflects = child == 1u;
        Refraction way = Refraction(surface.specular.reflection, surface.specular.reflected);
        Chain chain = Chain(parent.chain.has_one_channel, surface.environment);
        if (!reflects) {
            way = refraction_of(surface.specular, channel, chain.has_one_channel);
            chain.has_one_channel = chain.has_one_channel || surface.specular.splits;
        }
        const vec3 weight = parent.weight * way.share;
        if (!(largest(weight) >= MinBranchWeight)) continue;
        const float probability = parent.probability * (reflects ? chances.reflection : chances.refraction);
        const Ray ray = leaving(surface, way.direction);
        open.branches[open.count] =
            Branch(ray, cone, weight, probability, 2u * parent.node + child, parent.depth + 1u, chain,
                   inside_after(scene, inside, surface, way.direction), new_course(ray.origin), false, false);
        open.count += 1u;
    }
}

// What is behind a place in a medium that the branch is scattered at; there is room, since it has no children
// yet.
inline void push_rest(INOUT(BranchStack) open, IN(Branch) branch, IN(Path) path, IN(Ray) ray,
                      IN(Course) course, bool first) {
    Branch rest = branch;
    rest.ray = ray;
    rest.cone = path.cone;
    rest.weight = path.throughput;
    rest.inside = path.inside;
    rest.passes = true;
    rest.course = course;
    rest.first = first;
    open.branches[open.count] = rest;
    open.count += 1u;
}

inline void enter_branch(INOUT(Path) path, IN(Branch) branch) {
    path.vertex = branch.node;
    path.throughput = branch.weight;
    path.probability = branch.probability;
    path.bsdf_pdf = 0.0f;
    path.cone = branch.cone;
    path.chain = branch.chain;
    path.inside = branch.inside;
    path.way = direct_way();
}

// Head light and unoccluded ambient light (Schwenk 2A.3), in [0, 1] for albedos in [0, 1]:
// sum over branches of weight x albedo / 2 x (1 + max(0, n . -d)); nothing where a branch leaves the scene.
inline vec3 range_at(IN(Branch) branch, IN(Surface) surface) {
    const float facing = -dot(surface.frame[2], branch.ray.direction);
    return branch.weight * surface.albedo * (surface.rough_share * 0.5f * (1.0f + greater_of(facing, 0.0f)));
}

SHADING_END

#endif
