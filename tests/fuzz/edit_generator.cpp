#include "tests/fuzz/edit_generator.h"

#include <algorithm>

#include "mediator/scene/fields.h"
#include "mediator/wire/envelope.h"
#include "tests/wire/described_values.h"

namespace tessera::test {

void EditGenerator::joined(const wire::SceneJoined& scene) {
    version_ = scene.version;
    first_id_ = scene.first_id;
    id_count_ = scene.id_count;
    sequence_ = scene.last_sequence;
    created_.clear();  // known again as they are created
    waiting_.clear();
}

void EditGenerator::answered(const wire::EditReply& reply) {
    const auto edit = waiting_.extract(reply.sequence);
    if (reply.result.accepted) {
        ++accepted_;
        if (edit.empty()) return;
        for (const ObjectId id : edit.mapped().removed) created_.erase(id);
        created_.insert(edit.mapped().created.begin(), edit.mapped().created.end());
        return;
    }
    // An edit that did not arrive leaves a gap.
    constexpr std::string_view Expected = "expected ";
    for (const std::string& problem : reply.result.problems) {
        const std::size_t at = problem.find(Expected);
        if (at != std::string::npos) sequence_ = std::stoull(problem.substr(at + Expected.size())) - 1;
    }
}

ObjectId EditGenerator::some_object() {
    if (random_.chance(60) && id_count_ > 0)
        return ObjectId{first_id_ + random_.below(std::min<std::uint64_t>(id_count_, 64))};
    if (random_.chance(50)) return ObjectId{spared_.value + random_.below(64)};
    return random_.chance(30) ? scene::RootId : ObjectId{random_.extreme()};
}

Version EditGenerator::some_version() {
    Version version = version_;
    if (random_.chance(30)) version.number += random_.below(5);
    if (random_.chance(10)) version = {random_.extreme(), random_.extreme()};
    return version;
}

ObjectId EditGenerator::new_id() {
    return ObjectId{first_id_ + next_object_++ % std::max<std::uint64_t>(1, id_count_)};
}

scene::Edit EditGenerator::edit() {
    scene::Edit edit{.sequence = random_.chance(90) ? ++sequence_ : random_.extreme()};
    edit.base = some_version();
    edit.edit_group = random_.below(3);
    if (random_.chance(20)) {
        edit.undo = random_.chance(50) ? scene::UndoLatest : random_.extreme();
        if (random_.chance(20)) edit.entries = random_entries();
        return edit;
    }
    const std::uint64_t dice = random_.below(1000);
    if (dice < 4) {
        edit.entries = many_entries(2'000 + random_.below(3'000));  // the nodes get them as a blob
    } else if (dice < 30) {
        edit.entries = deep_entries();
    } else {
        edit.entries = dice < 300 ? random_entries() : plain_entries(edit.sequence);
    }
    return edit;
}

// Of any objects and with any values; few are accepted.
std::vector<scene::Entry> EditGenerator::random_entries() {
    std::vector<scene::Entry> entries;
    wire::test::fill(entries, random_.stream());
    for (scene::Entry& entry : entries) {
        std::visit([&](auto& each) { each.id = some_object(); }, entry);
        // Transforms and roots make graphs of any shape.
        if (auto* create = std::get_if<scene::Create>(&entry); create && random_.chance(50)) {
            scene::Transform transform{.name = random_.name("t")};
            for (std::uint64_t i = random_.below(4); i > 0; --i) transform.children.push_back(some_object());
            create->object = transform;
        }
    }
    return entries;
}

// Of its own objects; most of them are accepted.
std::vector<scene::Entry> EditGenerator::plain_entries(std::uint64_t sequence) {
    std::vector<scene::Entry> entries;
    std::set<ObjectId> touched;
    for (std::uint64_t i = 1 + random_.below(5); i > 0; --i) {
        const auto name = random_.name("object " + std::to_string(random_.below(1000)));
        const bool creates = created_.empty() || random_.chance(30);
        const ObjectId id = creates ? new_id()
                                    : *std::next(created_.begin(),
                                                 static_cast<std::ptrdiff_t>(random_.below(created_.size())));
        if (!touched.insert(id).second) continue;
        if (creates) {
            entries.emplace_back(scene::Create{id, scene::Transform{.name = name}});
            waiting_[sequence].created.push_back(id);
        } else if (random_.chance(80)) {
            scene::Transform moved{.name = name};
            moved.matrix[3] = {double(random_.below(1000)), 0, 0, 1};
            entries.emplace_back(scene::Update{
                id,
                scene::Fields<scene::Transform>(&scene::Transform::name, &scene::Transform::matrix).bits(),
                moved});
        } else {
            entries.emplace_back(scene::Remove{id});
            waiting_[sequence].removed.push_back(id);
        }
    }
    return entries;
}

// A graph that is deeper than back-ends can follow, or that has too many instances, in few objects; or a legal one.
std::vector<scene::Entry> EditGenerator::deep_entries() {
    const bool doubles = random_.chance(50);
    const std::uint64_t levels = random_.chance(30) ? 2 + random_.below(8)
                                 : doubles          ? 25 + random_.below(30)
                                                    : 1025 + random_.below(100);
    std::vector<scene::Entry> entries;
    std::vector<ObjectId> below{new_id()};
    entries.emplace_back(scene::Create{below.front(), scene::Light{}});
    for (std::uint64_t level = 0; level < levels; ++level) {
        std::vector<ObjectId> ids;
        for (std::uint64_t i = 0; i < (doubles ? 2 : 1); ++i) {
            ids.push_back(new_id());
            entries.emplace_back(scene::Create{ids.back(), scene::Transform{.children = below}});
        }
        below = std::move(ids);
    }
    entries.emplace_back(scene::Update{scene::RootId,
                                       scene::Fields<scene::Root>(&scene::Root::children).bits(),
                                       scene::Root{.children = below}});
    return entries;
}

std::vector<scene::Entry> EditGenerator::many_entries(std::size_t count) {
    std::vector<scene::Entry> entries;
    for (std::size_t i = 0; i < count; ++i) entries.emplace_back(scene::Create{new_id(), scene::Transform{}});
    return entries;
}

// A few bytes on the wire for each entry, and much memory.
EditGenerator::Encoded EditGenerator::long_edit() {
    constexpr std::size_t Part = 1000;
    scene::Edit edit{.sequence = ++sequence_, .base = some_version(), .entries = {}};
    for (std::size_t i = 0; i < Part; ++i) edit.entries.emplace_back(scene::Remove{new_id()});
    Encoded encoded{.head = {.session = {}, .sequence = edit.sequence, .base = edit.base, .blob = {}},
                    .bytes = {}};
    const std::vector<std::byte> part = wire::encode(edit);
    for (std::uint64_t i = 300 + random_.below(700); i > 0; --i)
        encoded.bytes.insert(encoded.bytes.end(), part.begin(), part.end());
    return encoded;
}

}  // namespace tessera::test
