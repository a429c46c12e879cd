#pragma once

#include "backends/embree/transport.h"

namespace tessera::embree {

// Perfect speculars followed through both branches (Whitted 1980).
inline constexpr std::uint32_t MaxSpecularDepth = 8;
// A branch that carries less than half a step of an 8-bit picture is not followed.
inline constexpr float MinBranchWeight = 1.0f / 512.0f;

struct Branch {
    Ray ray;
    glm::vec3 weight{1.0f};    // of what is seen along it
    float probability = 1.0f;  // with which a path that chooses one lobe at a time would come here
    std::uint32_t node = 0;    // in the tree of branches, breadth first: 0, then 2 node + 1 and 2 node + 2
    std::uint32_t depth = 0;
};

class BranchVisitor {
  public:
    virtual ~BranchVisitor() = default;
    // Any hit. What is not perfect specular about it ends here: the share surface.rough_share.
    virtual void hit(const Branch& branch, const Surface& surface) = 0;
    virtual void miss(const Branch& branch) = 0;  // leaves the scene
};

// From a first hit that is already known. Traces no ray where that is no perfect specular. `path` tells the
// random numbers and counts the rays.
void follow_speculars(const RayCaster& rays, const Ray& camera_ray, const Surface& first, Path& path,
                      BranchVisitor& visitor);

// Head light and unoccluded ambient light (Schwenk 2A.3), in [0, 1] for albedos in [0, 1]:
// sum over branches of weight x albedo / 2 x (1 + max(0, n . -d)); nothing where a branch leaves the scene.
glm::vec3 range_of(const RayCaster& rays, const Ray& camera_ray, const Surface& first, Path& path);

// The renderer of that name: emission and sky along all branches, and where one ends on a surface direct
// light, as path tracing finds it with max_bounces = 0. The features of a sample are the branches' by their
// weights, the normal by their probabilities. `channels` tells whether the range is wanted.
void trace_whitted(const RayCaster& rays, const Transport& transport, const Ray& camera_ray,
                   const Surface& first, frame::ChannelSet channels, Path& path);

}  // namespace tessera::embree
