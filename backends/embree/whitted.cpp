#include "backends/embree/whitted.h"

#include <array>
#include <cmath>

namespace tessera::embree {

namespace {

// Branches still to follow: depth first, so one sibling per level at most.
class BranchStack {
  public:
    bool empty() const { return size_ == 0; }
    Branch pop() { return branches_[--size_]; }
    void push_children(const Branch& parent, const Surface& surface) {
        if (surface.rough_share == 1.0f || parent.depth == MaxSpecularDepth) return;
        const LobeChances chances = lobe_chances(surface);
        const shading::Specular& specular = surface.specular;
        push(parent, surface, {specular.reflection, chances.reflection, specular.reflected, 1});
        push(parent, surface, {specular.refraction, chances.refraction, specular.refracted, 2});
    }

  private:
    struct Way {
        const glm::vec3& share;
        float probability;
        const glm::vec3& direction;
        std::uint32_t child;
    };
    void push(const Branch& parent, const Surface& surface, const Way& way) {
        const glm::vec3 weight = parent.weight * way.share;
        if (!(shading::largest(weight) >= MinBranchWeight)) return;
        const glm::vec3 origin =
            leave_surface({surface.position, surface.error}, surface.geometric_normal, way.direction);
        branches_[size_++] = {.ray = {origin, way.direction},
                              .weight = weight,
                              .probability = parent.probability * way.probability,
                              .node = 2 * parent.node + way.child,
                              .depth = parent.depth + 1};
    }

    std::array<Branch, MaxSpecularDepth + 1> branches_;
    std::size_t size_ = 0;
};

class RangeSum final : public BranchVisitor {
  public:
    void hit(const Branch& branch, const Surface& surface) override {
        const float facing = -glm::dot(surface.frame[2], branch.ray.direction);
        sum +=
            branch.weight * surface.albedo * (surface.rough_share * 0.5f * (1.0f + std::fmax(facing, 0.0f)));
    }
    void miss(const Branch&) override {}

    glm::vec3 sum{0.0f};
};

class DirectLight final : public BranchVisitor {
  public:
    DirectLight(const RayCaster& rays, const Transport& transport, Path& path)
        : rays_(rays), transport_(transport), path_(path) {}

    void hit(const Branch& branch, const Surface& surface) override {
        start(branch);
        transport_.add_emission(path_, branch.ray, surface);
        if (!(surface.rough_share > 0.0f)) return;
        path_.probability *= lobe_chances(surface).rough;
        path_.sample.albedo += branch.weight * surface.albedo * surface.rough_share;
        path_.sample.normal += path_.probability * surface.frame[2];
        if (surface.scatters) gather(branch, surface);
    }
    void miss(const Branch& branch) override {
        start(branch);
        transport_.add_sky(path_, branch.ray);
    }

  private:
    void start(const Branch& branch) {
        path_.vertex = branch.node;
        path_.throughput = branch.weight;
        path_.probability = branch.probability;
        path_.bsdf_pdf = 0.0f;
        path_.way = {};
    }
    void gather(const Branch& branch, const Surface& surface) {
        const glm::vec3 out = surface.to_local(-branch.ray.direction);
        transport_.add_lights(path_, surface, out);
        Ray ray;
        if (!transport_.scatter(path_, surface, out, transport_.rough_lobe(path_), ray)) return;
        ++path_.vertex;
        ++path_.rays;
        const std::optional<Hit> hit = rays_.closest(ray, path_.closest_seed());
        if (!hit) return transport_.add_sky(path_, ray);
        transport_.add_emission(path_, ray, make_surface(rays_.tables(), hit->hit, ray.direction));
    }

    const RayCaster& rays_;
    const Transport& transport_;
    Path& path_;
};

// Both at a time, for the same rays.
class Both final : public BranchVisitor {
  public:
    Both(BranchVisitor& first, BranchVisitor& second) : first_(first), second_(second) {}
    void hit(const Branch& branch, const Surface& surface) override {
        first_.hit(branch, surface);
        second_.hit(branch, surface);
    }
    void miss(const Branch& branch) override {
        first_.miss(branch);
        second_.miss(branch);
    }

  private:
    BranchVisitor& first_;
    BranchVisitor& second_;
};

}  // namespace

void follow_speculars(const RayCaster& rays, const Ray& camera_ray, const Surface& first, Path& path,
                      BranchVisitor& visitor) {
    const Branch root{.ray = camera_ray};
    visitor.hit(root, first);
    BranchStack open;
    open.push_children(root, first);
    const std::uint32_t vertex = path.vertex;
    while (!open.empty()) {
        const Branch branch = open.pop();
        ++path.rays;
        path.vertex = branch.node;
        const std::optional<Hit> hit = rays.closest(branch.ray, path.closest_seed());
        if (!hit) {
            visitor.miss(branch);
            continue;
        }
        const Surface surface = make_surface(rays.tables(), hit->hit, branch.ray.direction);
        visitor.hit(branch, surface);
        open.push_children(branch, surface);
    }
    path.vertex = vertex;
}

glm::vec3 range_of(const RayCaster& rays, const Ray& camera_ray, const Surface& first, Path& path) {
    RangeSum range;
    follow_speculars(rays, camera_ray, first, path, range);
    return range.sum;
}

void trace_whitted(const RayCaster& rays, const Transport& transport, const Ray& camera_ray,
                   const Surface& first, frame::ChannelSet channels, Path& path) {
    DirectLight light(rays, transport, path);
    if (!channels.contains(frame::Channel::Range))
        return follow_speculars(rays, camera_ray, first, path, light);
    RangeSum range;
    Both both(light, range);
    follow_speculars(rays, camera_ray, first, path, both);
    path.sample.range = range.sum;
}

}  // namespace tessera::embree
