#include "master/render/picture_effect.h"

#include <set>
#include <variant>
#include <vector>

#include "mediator/scene/fields.h"
#include "mediator/scene/referrers.h"

namespace tessera::master {

namespace {

using namespace scene;

constexpr PictureEffect Everything{.samples = true, .lights_or_materials = true, .geometry = true};
constexpr PictureEffect Radiance{.samples = true, .lights_or_materials = true};
constexpr PictureEffect Shape{.samples = true, .geometry = true};

void add(const PictureEffect& more, PictureEffect& to) {
    to.samples |= more.samples;
    to.lights_or_materials |= more.lights_or_materials;
    to.geometry |= more.geometry;
}

// Searches for geometries and lights at or below moved objects. Ends as soon as it has found both; once it has found a
// geometry it looks at no more than SearchLimit objects, and what is larger is taken to contain a light. Subtrees are
// visited once, however deep and shared they are.
class ContentSearch {
  public:
    explicit ContentSearch(const Scene& scene) : scene_(scene) {}

    // Adds the effect of moving the object.
    void moved(ObjectId start, PictureEffect& effect) {
        struct Step {
            const std::vector<ObjectId>* below;
            std::size_t next = 0;
        };
        const std::vector<ObjectId> top{start};
        std::vector<Step> open{{&top}};
        std::size_t visited = 0;
        while (!open.empty() && !(effect.lights_or_materials && effect.geometry)) {
            Step& step = open.back();
            if (step.next == step.below->size()) {
                open.pop_back();
                continue;
            }
            const ObjectId id = (*step.below)[step.next++];
            const Object* object = scene_.find(id);
            const bool is_unknown = object == nullptr || (effect.geometry && ++visited > SearchLimit);
            if (is_unknown) return add(Everything, effect);
            if (const auto* geometry = std::get_if<Geometry>(object)) {
                add(emits(*geometry) ? Everything : Shape, effect);
            } else if (std::holds_alternative<Light>(*object)) {
                add(Radiance, effect);
            }
            const std::vector<ObjectId>& below = children(*object);
            if (!below.empty() && walked_.insert(id).second) open.push_back({&below});
        }
    }

    bool emits(const Geometry& geometry) const {
        const auto any = [](const glm::vec3& color) {
            return color.x > 0.0f || color.y > 0.0f || color.z > 0.0f;
        };
        const Object* material = scene_.find(geometry.material);
        if (material == nullptr) return false;
        if (const auto* gltf = std::get_if<Material>(material)) return any(gltf->emission);
        if (const auto* shader = std::get_if<SurfaceShader>(material)) return any(shader->emission);
        return false;
    }

  private:
    static constexpr std::size_t SearchLimit = 1000;
    const Scene& scene_;
    std::set<ObjectId> walked_;
};

// Adds the effect of an update, per kind.
struct EffectOf {
    const Update& update;
    ContentSearch& content;
    PictureEffect& effect;

    template <class T>
    bool any(Fields<T> fields) const {
        return Fields<T>::from_bits(update.mask).intersects(fields);
    }
    template <class T>
    bool any_but(Fields<T> fields) const {
        return any(Fields<T>::from_bits(~fields.bits()));
    }
    void operator()(const Root&) const {
        if (any<Root>({&Root::children, &Root::render_origin})) add(Everything, effect);
        if (any<Root>(&Root::background)) add(Radiance, effect);
    }
    void operator()(const Transform&) const {
        if (any<Transform>(&Transform::children)) add(Everything, effect);
        if (any<Transform>({&Transform::matrix, &Transform::motion, &Transform::layers}))
            content.moved(update.id, effect);
    }
    void operator()(const Geometry&) const {
        if (any<Geometry>({&Geometry::material, &Geometry::medium})) add(Radiance, effect);
        if (any_but<Geometry>({&Geometry::name, &Geometry::hint, &Geometry::material, &Geometry::medium}))
            content.moved(update.id, effect);
    }
    void operator()(const Camera&) const {}
    void operator()(const Attachment&) const {}
    template <class Other>
    void operator()(const Other&) const {
        if (any_but<Other>(&Other::name)) add(Radiance, effect);
    }
};

}  // namespace

PictureEffect picture_effect(const ChangeList& changes, const Scene& after) {
    if (changes.is_snapshot()) return Everything;
    PictureEffect effect;
    ContentSearch content(after);
    for (const Entry& entry : changes.entries) {
        if (const auto* update = std::get_if<Update>(&entry))
            std::visit(EffectOf{*update, content, effect}, update->fields);
    }
    return effect;
}

}  // namespace tessera::master
