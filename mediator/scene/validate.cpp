#include "mediator/scene/validate.h"

#include <algorithm>
#include <set>

#include "mediator/scene/fields.h"
#include "mediator/scene/referrers.h"
#include "mediator/scene/validate_object.h"

namespace tessera::scene {

namespace {

constexpr std::uint64_t IdLimit = std::uint64_t{1} << 32;
constexpr FieldMask Any = ~FieldMask{0};
// Up to this number of parents with new children are checked one by one, towards the root; more in one traversal of
// the graph.
constexpr std::size_t FewParents = 16;

void check_reference(const Scene& scene, ObjectId id, const Object& object, const Reference& reference,
                     std::vector<Problem>& problems) {
    const Object* target = scene.find(reference.id);
    if (target == nullptr) {
        problems.push_back({id, describe(id, object) + " refers to object " +
                                    std::to_string(reference.id.value) + " as its " +
                                    std::string(reference.field) + ", which is not there: create it first"});
    } else if ((reference.kinds & bit(kind(*target))) == 0) {
        problems.push_back({id, describe(id, object) + " cannot have " + describe(reference.id, *target) +
                                    " as its " + std::string(reference.field)});
    } else if (const auto* texture = std::get_if<Texture>(target);
               texture && texture->depth != 1 && !std::holds_alternative<Medium>(object)) {
        problems.push_back({id, describe(id, object) + " has " + describe(reference.id, *target) + " of " +
                                    std::to_string(texture->depth) + " slices as its " +
                                    std::string(reference.field) + ": only media can have volumes"});
    }
}

void check_references(const Scene& scene, ObjectId id, const Object& object, std::vector<Problem>& problems) {
    for (const Reference& reference : references(object)) {
        check_reference(scene, id, object, reference, problems);
    }
}

// Only media can use a texture that becomes a volume.
bool may_invalidate_users(const Object& object, FieldMask mask) {
    const auto* texture = std::get_if<Texture>(&object);
    return texture && texture->depth != 1 && Fields<Texture>::from_bits(mask).contains(&Texture::depth);
}

void report_dangling(ObjectId id, const Object& object, ObjectId gone, std::vector<Problem>& problems) {
    problems.push_back({id, describe(id, object) + " still refers to object " + std::to_string(gone.value) +
                                ", which is removed: change it as well"});
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
    return object ? children(*object) : None;
}

// Depth-first without recursion, since a malformed graph may be a million levels deep. `done` holds the objects known
// to be free of cycles, so that shared subgraphs are visited once.
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
        return;  // one is enough: others may report the same cycle
    }
}

struct NewChildren {
    ObjectId parent;
    std::vector<ObjectId> children;
};

// A new child closes a cycle if it is the parent or one of its ancestors.
bool closes_cycle(const ReferrerIndex& referrers, const NewChildren& link) {
    std::set<ObjectId> above{link.parent};
    std::vector<ObjectId> open{link.parent};
    while (!open.empty()) {
        const ObjectId next = open.back();
        open.pop_back();
        for (const ObjectId parent : referrers.referrers(next)) {
            if (above.insert(parent).second) open.push_back(parent);
        }
    }
    return std::any_of(link.children.begin(), link.children.end(),
                       [&](ObjectId child) { return above.contains(child); });
}

void check_new_children(const Scene& scene, const ReferrerIndex& referrers,
                        const std::vector<NewChildren>& links, std::vector<Problem>& problems) {
    std::vector<ObjectId> starts;
    for (const NewChildren& link : links) {
        if (links.size() > FewParents || closes_cycle(referrers, link)) starts.push_back(link.parent);
    }
    check_cycles(scene, starts, problems);
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
    std::set<ObjectId> removed, volumes;
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
        const FieldMask mask = update ? update->mask : Any;
        if (may_invalidate_users(*object, mask)) volumes.insert(target);
        const bool children_touched =
            !children_of(object).empty() && (mask & children_field(kind(*object))) != 0;
        if (children_touched) parents.push_back(target);
    }
    check_cycles(scene, parents, problems);
    // Objects may still refer to a removed one, or use a texture that became a volume: all objects are checked.
    if (removed.empty() && volumes.empty()) return problems;
    for (const auto& [id, object] : scene.objects()) {
        for (const Reference& reference : references(*object)) {
            if (removed.contains(reference.id)) report_dangling(id, *object, reference.id, problems);
            if (volumes.contains(reference.id)) check_reference(scene, id, *object, reference, problems);
        }
    }
    return problems;
}

std::vector<Problem> validate_changes(const Scene& scene, const ReferrerIndex& referrers,
                                      const std::vector<ObjectChange>& changes) {
    std::vector<Problem> problems;
    std::vector<NewChildren> links;
    if (scene.find(RootId) == nullptr)
        problems.push_back({RootId, "the scene has no root: create object 1 as root"});
    for (const ObjectChange& change : changes) {
        const bool volume = change.after && may_invalidate_users(*change.after, change.mask);
        if (change.before && (!change.is_update() || volume)) {
            for (const ObjectId id : referrers.referrers(change.id)) {
                const Object& object = *scene.find(id);
                if (!change.after) {
                    report_dangling(id, object, change.id, problems);
                    continue;
                }
                for (const Reference& reference : references(object)) {
                    if (reference.id == change.id) check_reference(scene, id, object, reference, problems);
                }
            }
        }
        if (!change.after) continue;
        check_alone(change.id, *change.after, problems);
        if (change.is_update() && (change.mask & reference_fields(kind(*change.after))) == 0) continue;
        NewChildren link{change.id, {}};
        for (const Reference& reference : reference_change(change.before.get(), change.after.get()).added) {
            check_reference(scene, change.id, *change.after, reference, problems);
            const bool may_lead_back =
                reference.id == change.id || !children_of(scene.find(reference.id)).empty();
            if (may_lead_back) link.children.push_back(reference.id);
        }
        if (!link.children.empty()) links.push_back(std::move(link));
    }
    check_new_children(scene, referrers, links, problems);
    return problems;
}

}  // namespace tessera::scene
