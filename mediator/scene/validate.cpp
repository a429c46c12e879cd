#include "mediator/scene/validate.h"

#include <set>

#include "mediator/scene/fields.h"
#include "mediator/scene/validate_object.h"

namespace tessera::scene {

namespace {

constexpr std::uint64_t IdLimit = std::uint64_t{1} << 32;
constexpr std::uint32_t Any = ~0u;

constexpr std::uint32_t bit(ObjectKind kind) {
    return 1u << static_cast<unsigned>(kind);
}

struct Reference {
    ObjectId id;
    std::uint32_t kinds;  // allowed
    const char* role;
};

std::vector<Reference> references(const Object& object) {
    constexpr std::uint32_t Children = bit(ObjectKind::Transform) | bit(ObjectKind::Geometry) |
                                       bit(ObjectKind::Light) | bit(ObjectKind::Camera) |
                                       bit(ObjectKind::Attachment);
    std::vector<Reference> found;
    const auto add = [&](ObjectId id, std::uint32_t kinds, const char* role) {
        if (id) found.push_back({id, kinds, role});
    };
    if (const auto* root = std::get_if<Root>(&object)) {
        for (const ObjectId child : root->children) found.push_back({child, Children, "child"});
        add(root->background, bit(ObjectKind::Background), "background");
    } else if (const auto* transform = std::get_if<Transform>(&object)) {
        for (const ObjectId child : transform->children) found.push_back({child, Children, "child"});
    } else if (const auto* geometry = std::get_if<Geometry>(&object)) {
        add(geometry->material, bit(ObjectKind::Material), "material");
    } else if (const auto* material = std::get_if<Material>(&object)) {
        for (const TextureSlot* slot : {&material->base_color_texture, &material->metallic_roughness_texture,
                                        &material->normal_texture, &material->emission_texture}) {
            add(slot->texture, bit(ObjectKind::Texture), "texture");
        }
    } else if (const auto* background = std::get_if<Background>(&object)) {
        add(background->environment, bit(ObjectKind::Texture), "environment");
    }
    return found;
}

void check_references(const Scene& scene, ObjectId id, const Object& object, std::vector<Problem>& problems) {
    for (const Reference& reference : references(object)) {
        const Object* target = scene.find(reference.id);
        if (target == nullptr) {
            problems.push_back({id, describe(id, object) + " refers to object " +
                                        std::to_string(reference.id.value) + " as its " + reference.role +
                                        ", which is not there: create it first"});
        } else if ((reference.kinds & bit(kind(*target))) == 0) {
            problems.push_back({id, describe(id, object) + " cannot have " + describe(reference.id, *target) +
                                        " as its " + reference.role});
        }
    }
}

void check_identity(ObjectId id, const Object& object, std::vector<Problem>& problems) {
    if (id.value == 0 || id.value >= IdLimit) {
        problems.push_back({id, "object id " + std::to_string(id.value) + " is not between 1 and 2^32 - 1"});
    }
    if (std::holds_alternative<Root>(object) != (id == RootId)) {
        problems.push_back({id, describe(id, object) + ": object 1 and no other is the root"});
    }
}

void check_alone(ObjectId id, const Object& object, std::vector<Problem>& problems) {
    check_identity(id, object, problems);
    for (std::string& message : problems_of(id, object)) problems.push_back({id, std::move(message)});
}

const std::vector<ObjectId>& children_of(const Object* object) {
    static const std::vector<ObjectId> None;
    if (object == nullptr) return None;
    if (const auto* transform = std::get_if<Transform>(object)) return transform->children;
    if (const auto* root = std::get_if<Root>(object)) return root->children;
    return None;
}

// Depth-first without recursion, since a hostile graph may be a million deep. `done` holds what is known to
// be free of cycles, so shared subgraphs are walked once.
bool reaches_itself(const Scene& scene, ObjectId start, std::set<ObjectId>& done) {
    struct Step {
        ObjectId id;
        std::size_t next = 0;
    };
    std::vector<Step> path{{start}};
    std::set<ObjectId> on_path{start};
    if (done.contains(start)) return false;
    while (!path.empty()) {
        Step& step = path.back();
        const auto& children = children_of(scene.find(step.id));
        if (step.next == children.size()) {
            done.insert(step.id);
            on_path.erase(step.id);
            path.pop_back();
            continue;
        }
        const ObjectId child = children[step.next++];
        if (on_path.contains(child)) return true;
        if (children_of(scene.find(child)).empty() || done.contains(child)) continue;
        on_path.insert(child);
        path.push_back({child});
    }
    return false;
}

void check_cycles(const Scene& scene, const std::vector<ObjectId>& starts, std::vector<Problem>& problems) {
    std::set<ObjectId> done;
    for (const ObjectId start : starts) {
        if (!reaches_itself(scene, start, done)) continue;
        problems.push_back(
            {start, describe(start, *scene.find(start)) +
                        " is among its own descendants: take it out of one of the child lists"});
        return;  // one is enough: others may be the same cycle
    }
}

}  // namespace

std::vector<Problem> validate(const Scene& scene) {
    std::vector<Problem> problems;
    std::vector<ObjectId> parents;
    if (scene.find(RootId) == nullptr)
        problems.push_back({RootId, "the scene has no root: create object 1 as root"});
    for (const auto& [id, object] : scene.objects()) {
        check_alone(id, *object, problems);
        check_references(scene, id, *object, problems);
        if (!children_of(object.get()).empty()) parents.push_back(id);
    }
    check_cycles(scene, parents, problems);
    return problems;
}

std::vector<Problem> validate_entries(const Scene& scene, const std::vector<Entry>& entries) {
    std::vector<Problem> problems;
    std::vector<ObjectId> parents;
    std::set<ObjectId> removed;
    if (scene.find(RootId) == nullptr)
        problems.push_back({RootId, "the scene has no root: create object 1 as root"});
    for (const Entry& entry : entries) {
        const ObjectId target = id(entry);
        const Object* object = scene.find(target);
        if (object == nullptr) {
            removed.insert(target);
            continue;
        }
        check_alone(target, *object, problems);
        check_references(scene, target, *object, problems);
        const auto* update = std::get_if<Update>(&entry);
        const std::uint32_t mask = update ? update->mask : Any;
        const bool children_touched =
            !children_of(object).empty() &&
            (!update || Fields<Transform>::from_bits(mask).contains(Transform::Field::Children) ||
             std::holds_alternative<Root>(*object));
        if (children_touched) parents.push_back(target);
    }
    check_cycles(scene, parents, problems);
    // A removal breaks whoever still refers to what is gone; that takes a look at everybody.
    if (removed.empty()) return problems;
    for (const auto& [id, object] : scene.objects()) {
        for (const Reference& reference : references(*object)) {
            if (!removed.contains(reference.id)) continue;
            problems.push_back({id, describe(id, *object) + " still refers to object " +
                                        std::to_string(reference.id.value) +
                                        ", which is removed: change it as well"});
        }
    }
    return problems;
}

}  // namespace tessera::scene
