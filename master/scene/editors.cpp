#include "master/scene/editors.h"

#include <algorithm>

namespace tessera::master {

namespace {

constexpr std::uint64_t IdsOfABatch = 1u << 24;
constexpr std::uint64_t IdsPerEditor = 1u << 20;           // 4,095 members at a time
constexpr std::uint64_t IdLimit = std::uint64_t{1} << 32;  // an object index must fit a film plane

bool meet(const IdRange& a, const IdRange& b) {
    return a.first < b.first + b.count && b.first < a.first + a.count;
}

bool in_use(const scene::Scene& scene, const IdRange& range) {
    const auto it = scene.objects().lower_bound(ObjectId{range.first});
    return it != scene.objects().end() && range.contains(it->first);
}

}  // namespace

EditorRecord* Editors::join(SessionId session, const std::string& user, std::uint64_t key,
                            const scene::Scene& scene) {
    if (const auto known = keys_.find({user, key}); key != 0 && known != keys_.end()) {
        EditorRecord& editor = editors_.at(known->second);
        if (editor.session != session) {
            leave(session);
            sessions_.erase(editor.session);  // the old connection can no longer edit
            editor.session = session;
            editor.may_skip = true;
            sessions_[session] = editor.number;
        }
        return &editor;
    }
    if (EditorRecord* present = of(session)) {
        if (key == 0 && present->key == 0) return present;
        leave(session);
    }
    const auto ids = free_ids(key == 0 ? IdsOfABatch : IdsPerEditor, scene);
    if (!ids) return nullptr;
    EditorRecord editor{.number = ++last_number_, .user = user, .key = key, .ids = *ids};
    editor.session = session;
    const std::uint64_t number = editor.number;
    sessions_[session] = number;
    if (key != 0) keys_[{user, key}] = number;
    return &(editors_[number] = std::move(editor));
}

EditorRecord* Editors::of(SessionId session) {
    return const_cast<EditorRecord*>(std::as_const(*this).of(session));
}

const EditorRecord* Editors::of(SessionId session) const {
    const auto it = sessions_.find(session);
    return it == sessions_.end() ? nullptr : &editors_.at(it->second);
}

EditorRecord* Editors::by_number(std::uint64_t number) {
    const auto it = editors_.find(number);
    return it == editors_.end() ? nullptr : &it->second;
}

void Editors::leave(SessionId session) {
    EditorRecord* editor = of(session);
    if (editor == nullptr) return;
    sessions_.erase(session);
    if (editor->key == 0) {
        editors_.erase(editor->number);
        return;
    }
    editor->session = {};
    if (editors_.size() - sessions_.size() > MaxDisconnected) forget_one_disconnected();
}

// Forgets the oldest of the disconnected editors.
void Editors::forget_one_disconnected() {
    const auto it = std::find_if(editors_.begin(), editors_.end(),
                                 [](const auto& entry) { return !entry.second.session; });
    if (it == editors_.end()) return;
    keys_.erase({it->second.user, it->second.key});
    editors_.erase(it);
}

void Editors::clear() {
    editors_.clear();
    sessions_.clear();
    keys_.clear();
    next_id_ = FirstAllocatedId;
}

void Editors::restore(EditorRecord editor) {
    last_number_ = std::max(last_number_, editor.number);
    next_id_ = std::max(next_id_, editor.ids.first + editor.ids.count);
    if (editor.key != 0) keys_[{editor.user, editor.key}] = editor.number;
    const std::uint64_t number = editor.number;
    editors_[number] = std::move(editor);
}

void Editors::answer_at(Version version) {
    for (auto& [number, editor] : editors_) editor.last_answer.version = version;
}

bool Editors::is_allocated(const IdRange& range) const {
    return std::any_of(editors_.begin(), editors_.end(),
                       [&](const auto& entry) { return meet(range, entry.second.ids); });
}

// The next id range that is not allocated and contains no object; wraps around once.
std::optional<IdRange> Editors::free_ids(std::uint64_t count, const scene::Scene& scene) {
    for (std::uint64_t tried = 0; tried <= IdLimit / count; ++tried) {
        if (next_id_ + count > IdLimit) next_id_ = FirstAllocatedId;
        const IdRange range{next_id_, count};
        next_id_ += count;
        if (!is_allocated(range) && !in_use(scene, range)) return range;
    }
    return std::nullopt;
}

}  // namespace tessera::master
