#include "master/scene/transaction.h"

#include "mediator/scene/fields.h"
#include "mediator/scene/referrers.h"

namespace tessera::master {

namespace {

template <class Visit>
void for_each_bit(scene::FieldMask mask, const Visit& visit) {
    for (std::uint32_t field = 0; mask != 0; ++field, mask >>= 1) {
        if (mask & 1u) visit(field);
    }
}

scene::FieldMask children_mask(const scene::ObjectChange& change) {
    return change.is_update() ? change.mask & scene::children_field(kind(*change.after)) : 0;
}

// The object before both changes: fields written by the first as they were before it, all others as before the
// second.
std::shared_ptr<const scene::Object> earliest(const scene::ObjectChange& first,
                                              const scene::ObjectChange& second) {
    const bool nothing_new = (second.mask & ~first.mask) == 0 && second.is_update();
    if (!first.before || nothing_new || first.before->index() != second.before->index()) return first.before;
    auto merged = std::make_shared<scene::Object>(*second.before);
    assign(*merged, *first.before, first.mask);
    return merged;
}

void record_writers(TransactionChange& change, const scene::ObjectChange& step, const WriterPtr& author,
                    WriterTable& writers) {
    if (!step.is_update()) {
        for (auto& [field, writer] : writers.take(step.id)) change.writers_before.try_emplace(field, writer);
        return;
    }
    for_each_bit(step.mask, [&](std::uint32_t field) {
        change.writers_before.try_emplace(field, writers.of(step.id, field));
        writers.set(step.id, field, author);
    });
}

}  // namespace

WriterPtr WriterTable::of(ObjectId id, std::uint32_t field) const {
    const ObjectWriters& object = of(id);
    const auto it = object.find(field);
    return it == object.end() ? nullptr : it->second;
}

const ObjectWriters& WriterTable::of(ObjectId id) const {
    static const ObjectWriters None;
    const auto group = groups_.find(group_of(id));
    if (group == groups_.end()) return None;
    const auto object = group->second->find(id);
    return object == group->second->end() ? None : object->second;
}

void WriterTable::set(ObjectId id, std::uint32_t field, const WriterPtr& writer) {
    if (writer) {
        groups_[group_of(id)].edit()[id][field] = writer;
    } else if (of(id).contains(field)) {
        ObjectWriters& writers = groups_.at(group_of(id)).edit().at(id);
        writers.erase(field);
        if (writers.empty()) (void)take(id);
    }
}

void WriterTable::set(ObjectId id, const ObjectWriters& writers) {
    for (const auto& [field, writer] : writers) set(id, field, writer);
}

ObjectWriters WriterTable::take(ObjectId id) {
    const auto group = groups_.find(group_of(id));
    if (group == groups_.end() || !group->second->contains(id)) return {};
    Group& objects = group->second.edit();
    ObjectWriters writers = std::move(objects.extract(id).mapped());
    if (objects.empty()) groups_.erase(group);
    return writers;
}

bool can_extend(const Transaction& transaction, const std::vector<scene::ObjectChange>& changes,
                const WriterTable& writers) {
    for (const scene::ObjectChange& step : changes) {
        const auto it = transaction.changes.all().find(step.id);
        if (it == transaction.changes.all().end()) continue;
        const scene::ObjectChange& so_far = it->second.object;
        if (!so_far.after || !step.before || so_far.after->index() != step.before->index()) return false;
        if (!so_far.is_update()) continue;
        bool ours = true;
        for_each_bit(children_mask(so_far) & step.mask, [&](std::uint32_t field) {
            const WriterPtr writer = writers.of(step.id, field);
            ours = ours && writer && writer->transaction == transaction.number;
        });
        if (!ours) return false;
    }
    return true;
}

void extend(Transaction& transaction, const std::vector<scene::ObjectChange>& changes, WriterTable& writers) {
    TransactionChanges::Map& all = transaction.changes.to_change();
    for (const scene::ObjectChange& step : changes) {
        const auto [it, fresh] = all.try_emplace(step.id);
        TransactionChange& change = it->second;
        record_writers(change, step, transaction.author, writers);
        if (fresh) {
            change.object = step;
            continue;
        }
        change.object.before = earliest(change.object, step);
        change.object.after = step.after;
        change.object.mask |= step.mask;
        if (!change.object.before && !change.object.after) all.erase(it);
    }
}

void record_undo(Transaction& undo, const std::vector<scene::ObjectChange>& changes,
                 const std::map<ObjectId, ObjectWriters>& brought_back, const scene::Scene& scene,
                 WriterTable& writers) {
    TransactionChanges::Map& all = undo.changes.to_change();
    for (const scene::ObjectChange& step : changes) {
        TransactionChange& change = all[step.id];
        change.object = step;
        if (!step.is_update()) change.writers_before = writers.take(step.id);
    }
    for (const auto& [id, fields] : brought_back) {
        const auto [it, fresh] = all.try_emplace(id);
        TransactionChange& change = it->second;
        if (fresh) {
            const auto& same = scene.objects().find(id)->second;
            change.object = {.id = id, .before = same, .after = same};
        }
        for (const auto& [field, writer] : fields) {
            if (change.object.is_update()) {
                change.object.mask |= scene::field_bit(field);
                change.writers_before[field] = writers.of(id, field);
            }
            writers.set(id, field, writer);
        }
        change.writers_after = fields;
    }
}

}  // namespace tessera::master
