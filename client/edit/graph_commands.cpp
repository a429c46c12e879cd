#include <algorithm>
#include <set>

#include "client/edit/command_functions.h"
#include "client/edit/graph.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/references.h"
#include "mediator/scene/referrers.h"

namespace tessera::edit {
namespace {

using scene::ObjectKind;

bool is_placed(ObjectKind kind) {
    return (scene::PlacedKinds & scene::bit(kind)) != 0;
}

void expect_placed(const DryRun& dry_run, ObjectId id, const Word& path) {
    if (is_placed(scene::kind(*dry_run.scene().find(id)))) return;
    throw ScriptError(
        path.column(),
        dry_run.path(id) +
            " cannot be placed in the scene graph: only transforms, geometries, lights, cameras and "
            "attachments can");
}

// Adds the objects that are referenced only by `removed`, transitively.
void add_unused(const scene::Scene& scene, std::set<ObjectId>& removed) {
    std::map<ObjectId, std::size_t> users;
    for (const auto& [id, object] : scene.objects()) {
        scene::for_each_reference(*object, [&](ObjectId to) { ++users[to]; });
    }
    std::vector<ObjectId> open(removed.begin(), removed.end());
    while (!open.empty()) {
        const scene::Object& object = *scene.find(open.back());
        open.pop_back();
        scene::for_each_reference(object, [&](ObjectId to) {
            if (to && --users[to] == 0 && scene.find(to) && removed.insert(to).second) open.push_back(to);
        });
    }
}

}  // namespace

std::vector<ObjectId>& children_of(scene::Object& object) {
    if (auto* root = std::get_if<scene::Root>(&object)) return root->children;
    return std::get<scene::Transform>(object).children;
}

scene::Entry children_update(ObjectId id, scene::Object object) {
    const scene::FieldMask mask = scene::children_field(scene::kind(object));
    return scene::Update{id, mask, std::move(object)};
}

ObjectId read_parent(const DryRun& dry_run, const Word& path) {
    const ObjectId id = dry_run.read(path);
    const ObjectKind kind = scene::kind(*dry_run.scene().find(id));
    if (kind == ObjectKind::Root || kind == ObjectKind::Transform) return id;
    throw ScriptError(path.column(), dry_run.path(id) + " cannot have children: name a transform, or root");
}

ObjectId new_id(DryRun& dry_run) {
    const auto id = dry_run.target().new_id();
    if (!id) throw ScriptError(1, id.error().what());
    return *id;
}

void create_object(DryRun& dry_run, const Arguments& given, std::size_t end) {
    Arguments arguments = given;
    const auto parent_path = take_keyword(arguments, "in", end);
    const ObjectKind kind = read_kind(arguments[0]);
    if (kind == ObjectKind::Root) throw ScriptError(arguments[0].column(), "a scene has exactly one root");
    if (kind == ObjectKind::Geometry || kind == ObjectKind::Texture) {
        throw ScriptError(arguments[0].column(),
                          std::string(kind_word(kind)) + " cannot be typed: import them with 'load FILE'");
    }
    if (parent_path && !is_placed(kind)) {
        throw ScriptError(parent_path->column(),
                          std::string(kind_word(kind)) + " are not placed in the scene graph: omit 'in'");
    }
    scene::Object object = default_object(kind);
    std::visit([&](auto& value) { value.name = arguments[1].text(); }, object);
    for (std::size_t i = 2; i < arguments.size(); ++i) {
        const Word& word = arguments[i];
        const std::size_t equals = word.find('=');
        if (equals == Word::None) {
            throw ScriptError(word.column(), "'" + word.text() +
                                                 "' is not FIELD=VALUE: write it without blanks, " +
                                                 "with commas between numbers");
        }
        const unsigned field = read_field(kind, word.part(0, equals));
        read_value(object, field, {word.part(equals + 1)}, end,
                   [&](const Word& path) { return dry_run.read(path); });
    }
    std::vector<scene::Entry> entries;
    const ObjectId id = new_id(dry_run);
    if (is_placed(kind)) {
        const ObjectId parent = parent_path ? read_parent(dry_run, *parent_path) : scene::RootId;
        scene::Object above = *dry_run.scene().find(parent);
        children_of(above).push_back(id);
        entries.push_back(children_update(parent, std::move(above)));
    }
    entries.emplace_back(scene::Create{id, std::move(object)});
    dry_run.apply(entries);
}

void attach_object(DryRun& dry_run, const Arguments& given, std::size_t end) {
    Arguments arguments = given;
    const auto parent_path = take_keyword(arguments, "in", end);
    if (!parent_path) throw ScriptError(end, "'attach' needs a parent: write 'attach PATH in PARENT'");
    const ObjectId id = dry_run.read(arguments[0]), parent = read_parent(dry_run, *parent_path);
    expect_placed(dry_run, id, arguments[0]);
    scene::Object above = *dry_run.scene().find(parent);
    auto& children = children_of(above);
    if (std::find(children.begin(), children.end(), id) != children.end()) {
        throw ScriptError(arguments[0].column(), dry_run.path(id) + " is already in " + dry_run.path(parent));
    }
    children.push_back(id);
    dry_run.apply({children_update(parent, std::move(above))});
}

void detach_object(DryRun& dry_run, const Arguments& given, std::size_t end) {
    Arguments arguments = given;
    const auto parent_path = take_keyword(arguments, "from", end);
    const ObjectId id = dry_run.read(arguments[0]);
    expect_placed(dry_run, id, arguments[0]);
    const ObjectId only = parent_path ? read_parent(dry_run, *parent_path) : ObjectId{};
    std::vector<scene::Entry> entries;
    for (const auto& [parent, object] : dry_run.scene().objects()) {
        const ObjectKind kind = scene::kind(*object);
        if (kind != ObjectKind::Root && kind != ObjectKind::Transform) continue;
        if (only && parent != only) continue;
        scene::Object above = *object;
        if (std::erase(children_of(above), id) > 0)
            entries.push_back(children_update(parent, std::move(above)));
    }
    if (entries.empty()) {
        throw ScriptError(arguments[0].column(), dry_run.path(id) + " is not in " +
                                                     (only ? dry_run.path(only) : "any transform") +
                                                     ": see 'tree'");
    }
    dry_run.apply(entries);
}

void remove_object(DryRun& dry_run, const Arguments& given, std::size_t end) {
    Arguments arguments = given;
    const bool is_deep = std::erase_if(arguments, [](const Word& word) { return word.is("-r"); }) > 0;
    if (arguments.size() != 1)
        throw ScriptError(end, "'remove' takes one path and optionally -r: remove PATH [-r]");
    const ObjectId id = dry_run.read(arguments[0]);
    if (id == scene::RootId) throw ScriptError(arguments[0].column(), "the root cannot be removed");
    const scene::Scene& scene = dry_run.scene();
    std::set<ObjectId> removed{id};
    if (is_deep) add_unused(scene, removed);

    std::vector<scene::Entry> entries;
    for (const auto& [user, object] : scene.objects()) {
        if (removed.contains(user)) continue;
        bool uses = false;
        scene::for_each_reference(*object, [&](ObjectId to) { uses |= removed.contains(to); });
        if (!uses) continue;
        scene::Object changed = *object;
        if (std::holds_alternative<scene::Root>(changed) ||
            std::holds_alternative<scene::Transform>(changed)) {
            std::erase_if(children_of(changed), [&](ObjectId to) { return removed.contains(to); });
        }
        scene::for_each_reference(changed, [&](ObjectId& to) {
            if (removed.contains(to)) to = {};
        });
        const scene::FieldMask mask = scene::differing_fields(*object, changed);
        entries.emplace_back(scene::Update{user, mask, std::move(changed)});
    }
    for (const ObjectId gone : removed) entries.emplace_back(scene::Remove{gone});
    dry_run.apply(entries);
}

}  // namespace tessera::edit
