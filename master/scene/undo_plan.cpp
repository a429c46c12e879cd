#include "master/scene/undo_plan.h"

#include <algorithm>
#include <set>
#include <unordered_map>

#include "master/scene/transaction_text.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/referrers.h"

namespace tessera::master {

namespace {

using scene::Object;

std::vector<ObjectId>& children_of(Object& object) {
    if (auto* root = std::get_if<scene::Root>(&object)) return root->children;
    return std::get<scene::Transform>(object).children;
}

class Planner {
  public:
    Planner(const Transaction& transaction, const scene::Scene& scene, const WriterTable& writers,
            const EditHistory& history, const WriterPtr& author)
        : transaction_(transaction), scene_(scene), writers_(writers), history_(history), author_(author) {}

    UndoPlan make() {
        for (const auto& [id, change] : transaction_.changes.all()) {
            if (!change.object.before) {
                take_out(id, change);
            } else if (!change.object.after) {
                bring_back(id, change);
            } else if (!change.object.is_update()) {
                turn_back(id, change);
            } else {
                restore(id, change);
            }
        }
        return std::move(plan_);
    }

  private:
    void note(const std::string& text) { plan_.notes.push_back(text); }

    void take_out(ObjectId id, const TransactionChange& change) {
        const Object* now = scene_.find(id);
        if (now == nullptr) return note(gone(id, *change.object.after));
        if (now->index() != change.object.after->index())
            return note(object_path(id, *now) + " is another object now: it stays");
        for (const auto& [field, writer] : writers_.of(id)) {
            if (still_ours(change, field, writer)) continue;
            note(object_path(id, *now) + " goes with what " + writer->name + " wrote to it since");
            break;
        }
        plan_.entries.emplace_back(scene::Remove{id});
    }

    void bring_back(ObjectId id, const TransactionChange& change) {
        if (const Object* now = scene_.find(id)) return note(object_path(id, *now) + " is there again");
        create(id, change);
    }

    void create(ObjectId id, const TransactionChange& change) {
        plan_.entries.emplace_back(scene::Create{id, *change.object.before});
        plan_.writers[id] = change.writers_before;
    }

    // It became an object of another kind under the same id.
    void turn_back(ObjectId id, const TransactionChange& change) {
        const Object* now = scene_.find(id);
        if (now == nullptr) return note(gone(id, *change.object.after));
        if (now->index() != change.object.after->index())
            return note(object_path(id, *now) + " is another object now: it stays");
        plan_.entries.emplace_back(scene::Remove{id});
        create(id, change);
    }

    void restore(ObjectId id, const TransactionChange& change) {
        const Object* now = scene_.find(id);
        if (now == nullptr) return note(gone(id, *change.object.before));
        if (now->index() != change.object.before->index())
            return note(object_path(id, *now) + " is another object now: it stays");
        scene::Update update{id, 0, scene::copy_of_fields(*change.object.before, change.object.mask)};
        const scene::FieldMask children = scene::children_field(kind(*now));
        for (std::uint32_t field = 0; change.object.mask >> field != 0; ++field) {
            const scene::FieldMask bit = scene::field_bit(field);
            if ((change.object.mask & bit) == 0) continue;
            const WriterPtr writer = writers_.of(id, field);
            if (still_ours(change, field, writer)) {
                update.mask |= bit;
                const auto before = change.writers_before.find(field);
                plan_.writers[id][field] = before == change.writers_before.end() ? nullptr : before->second;
            } else if ((bit & children) != 0) {
                update.mask |= bit;
                plan_.writers[id][field] = author_;
                merge_children(id, change, *now, update.fields);
            } else {
                note(object_path(id, *now) + " " + std::string(field_name(kind(*now), field)) + " stays as " +
                     (writer ? writer->name + " wrote it since" : "it is: its earlier writer came back"));
            }
        }
        if (update.mask != 0) plan_.entries.push_back(std::move(update));
    }

    bool still_ours(const TransactionChange& change, std::uint32_t field, const WriterPtr& writer) const {
        const std::uint64_t now = writer ? writer->transaction : 0;
        if (transaction_.nature == Nature::Edit) return now == transaction_.number;
        const auto left = change.writers_after.find(field);
        if (left == change.writers_after.end()) return now == transaction_.number;
        return now == (left->second ? left->second->transaction : 0);
    }

    void merge_children(ObjectId id, const TransactionChange& change, const Object& now, Object& to) {
        std::vector<ObjectId> merged =
            without_change(scene::children(*change.object.before), scene::children(*change.object.after),
                           scene::children(now));
        std::erase_if(merged, [&](ObjectId child) {
            const auto other = transaction_.changes.all().find(child);
            const bool comes = other != transaction_.changes.all().end() && !other->second.object.after;
            if (comes || scene_.find(child) != nullptr) return false;
            note("object " + std::to_string(child.value) + " does not come back to " + object_path(id, now) +
                 ": it was removed since" + by(child));
            return true;
        });
        children_of(to) = std::move(merged);
    }

    std::string gone(ObjectId id, const Object& object) const {
        return object_path(id, object) + " was removed since" + by(id);
    }
    std::string by(ObjectId id) const {
        const Transaction* remover = history_.remover(id);
        return remover ? " by " + remover->author->name : "";
    }

    const Transaction& transaction_;
    const scene::Scene& scene_;
    const WriterTable& writers_;
    const EditHistory& history_;
    const WriterPtr& author_;
    UndoPlan plan_;
};

}  // namespace

UndoPlan plan_undo(const Transaction& transaction, const scene::Scene& scene, const WriterTable& writers,
                   const EditHistory& history, const WriterPtr& author) {
    return Planner(transaction, scene, writers, history, author).make();
}

std::vector<ObjectId> without_change(const std::vector<ObjectId>& before, const std::vector<ObjectId>& after,
                                     const std::vector<ObjectId>& now) {
    std::unordered_map<ObjectId, std::int64_t> added;  // negative: removed that many times
    for (const ObjectId id : after) ++added[id];
    for (const ObjectId id : before) --added[id];

    std::vector<ObjectId> kept;
    for (auto id = now.rbegin(); id != now.rend(); ++id) {
        const auto place = added.find(*id);
        if (place != added.end() && place->second > 0) {
            --place->second;
        } else {
            kept.push_back(*id);
        }
    }
    std::reverse(kept.begin(), kept.end());

    std::vector<char> returns(before.size(), 0);
    for (std::size_t i = before.size(); i-- > 0;) {
        std::int64_t& count = added[before[i]];
        if (count >= 0) continue;
        ++count;
        returns[i] = 1;
    }
    const std::set<ObjectId> present(kept.begin(), kept.end());
    std::vector<ObjectId> result;
    std::unordered_map<ObjectId, std::vector<ObjectId>> followers;
    ObjectId anchor{};
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (!returns[i]) {
            if (present.contains(before[i])) anchor = before[i];
        } else if (anchor) {
            followers[anchor].push_back(before[i]);
        } else {
            result.push_back(before[i]);
        }
    }
    for (const ObjectId id : kept) {
        result.push_back(id);
        const auto follow = followers.find(id);
        if (follow == followers.end()) continue;
        result.insert(result.end(), follow->second.begin(), follow->second.end());
        followers.erase(follow);
    }
    return result;
}

}  // namespace tessera::master
