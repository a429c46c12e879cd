#include "mediator/wire/scene_codec.h"

#include "mediator/scene/fields.h"
#include "mediator/wire/common_mapping.h"
#include "mediator/wire/scene_mapping.h"

namespace tessera::wire {

namespace {

using scene::ObjectKind;

constexpr int MaxEntries = 16'000'000;

// The message of the kind that the object has.
template <class Visit>
void with_message(proto::Object& object, ObjectKind kind, const Visit& visit) {
    switch (kind) {
        case ObjectKind::Root:
            return visit(scene::Root{}, *object.mutable_root());
        case ObjectKind::Transform:
            return visit(scene::Transform{}, *object.mutable_transform());
        case ObjectKind::Geometry:
            return visit(scene::Geometry{}, *object.mutable_geometry());
        case ObjectKind::Material:
            return visit(scene::Material{}, *object.mutable_material());
        case ObjectKind::Texture:
            return visit(scene::Texture{}, *object.mutable_texture());
        case ObjectKind::Light:
            return visit(scene::Light{}, *object.mutable_light());
        case ObjectKind::Camera:
            return visit(scene::Camera{}, *object.mutable_camera());
        case ObjectKind::Background:
            return visit(scene::Background{}, *object.mutable_background());
        case ObjectKind::Attachment:
            return visit(scene::Attachment{}, *object.mutable_attachment());
        case ObjectKind::SurfaceShader:
            return visit(scene::SurfaceShader{}, *object.mutable_surface_shader());
        case ObjectKind::Medium:
            return visit(scene::Medium{}, *object.mutable_medium());
    }
}

void write(const scene::Object& object, scene::FieldMask mask, proto::Object& to) {
    with_message(to, kind(object),
                 [&]<class S>(const S&, auto& message) { map(Writer(mask), std::get<S>(object), message); });
}

scene::Object read(proto::Object& from, scene::FieldMask mask) {
    if (from.kind_case() == proto::Object::KIND_NOT_SET) malformed("an entry lacks its object");
    scene::Object object;
    with_message(from, static_cast<ObjectKind>(from.kind_case() - 1), [&]<class S>(S fields, auto& message) {
        map(Reader(mask), fields, message);
        object = std::move(fields);
    });
    return object;
}

}  // namespace

void write(const scene::Entry& entry, proto::Entry& to) {
    to.set_id(scene::id(entry).value);
    if (const auto* create = std::get_if<scene::Create>(&entry)) {
        to.set_action(proto::Entry::CREATE);
        write(create->object, ~scene::FieldMask{0}, *to.mutable_object());
    } else if (const auto* update = std::get_if<scene::Update>(&entry)) {
        to.set_action(proto::Entry::UPDATE);
        to.set_mask(update->mask);
        write(update->fields, update->mask, *to.mutable_object());
    } else {
        to.set_action(proto::Entry::REMOVE);
    }
}

scene::Entry read(proto::Entry& from) {
    const ObjectId id{from.id()};
    switch (from.action()) {
        case proto::Entry::CREATE:
            return scene::Create{id, read(*from.mutable_object(), ~scene::FieldMask{0})};
        case proto::Entry::UPDATE: {
            scene::Update update{id, from.mask(), read(*from.mutable_object(), from.mask())};
            if ((update.mask & ~scene::all_fields(update.fields)) != 0)
                malformed("an update has unknown fields");
            return update;
        }
        case proto::Entry::REMOVE:
            return scene::Remove{id};
        default:
            malformed("an entry's action is unknown");
    }
}

namespace {

template <class P>
void write_entries(const std::vector<scene::Entry>& entries, P& to) {
    for (const scene::Entry& entry : entries) wire::write(entry, *to.add_entries());
}

template <class P>
std::vector<scene::Entry> read_entries(P& from) {
    if (from.entries_size() > MaxEntries) malformed("it has more than 16 million entries");
    std::vector<scene::Entry> entries;
    for (proto::Entry& entry : *from.mutable_entries()) entries.push_back(wire::read(entry));
    return entries;
}

}  // namespace

void write(const scene::ChangeList& changes, proto::ChangeList& to) {
    map(Writer(), changes.from, *to.mutable_from());
    map(Writer(), changes.to, *to.mutable_to());
    map(Writer(), changes.state_hash, *to.mutable_state_hash());
    write_entries(changes.entries, to);
}

void read(proto::ChangeList& from, scene::ChangeList& changes) {
    map(Reader(), changes.from, *from.mutable_from());
    map(Reader(), changes.to, *from.mutable_to());
    map(Reader(), changes.state_hash, *from.mutable_state_hash());
    changes.entries = read_entries(from);
}

void write(const scene::Edit& edit, proto::Edit& to) {
    to.set_session(edit.session.value);
    to.set_sequence(edit.sequence);
    map(Writer(), edit.base, *to.mutable_base());
    write_entries(edit.entries, to);
    to.set_gesture(edit.gesture);
    to.set_submitted_at(edit.submitted_at);
    to.set_undo(edit.undo);
}

void read(proto::Edit& from, scene::Edit& edit) {
    edit.session = SessionId{from.session()};
    edit.sequence = from.sequence();
    map(Reader(), edit.base, *from.mutable_base());
    edit.entries = read_entries(from);
    edit.gesture = from.gesture();
    edit.submitted_at = from.submitted_at();
    edit.undo = from.undo();
}

}  // namespace tessera::wire
