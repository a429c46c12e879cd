#include "master/scene/transaction_text.h"

#include <algorithm>
#include <vector>

#include "mediator/scene/fields.h"
#include "mediator/scene/referrers.h"

namespace tessera::master {

namespace {

constexpr std::size_t MaxName = 60;
constexpr std::size_t MaxFields = 4;

std::string path_of(const scene::ObjectChange& change) {
    return object_path(change.id, change.after ? *change.after : *change.before);
}

std::string fields_of(const scene::ObjectChange& change) {
    std::string text;
    std::size_t named = 0, more = 0;
    for (std::uint32_t field = 0; change.mask >> field != 0; ++field) {
        if (((change.mask >> field) & 1u) == 0) continue;
        if (named == MaxFields) {
            ++more;
            continue;
        }
        text += (named++ == 0 ? " " : ", ") + std::string(field_name(kind(*change.after), field));
    }
    if (more != 0) text += " and " + std::to_string(more) + " more";
    return text;
}

// Child links of created and removed objects are not mentioned.
bool only_links(const scene::ObjectChange& change) {
    return change.is_update() && change.mask == scene::children_field(kind(*change.after));
}

void append(std::string& text, const char* verb, const std::vector<const scene::ObjectChange*>& changes) {
    if (changes.empty()) return;
    text += (text.empty() ? "" : ", ") + std::string(verb) + " ";
    if (changes.size() > 1) {
        text += std::to_string(changes.size()) + " objects";
        return;
    }
    text += path_of(*changes[0]);
    if (changes[0]->is_update()) text += fields_of(*changes[0]);
}

}  // namespace

std::string shown(const std::string& text, std::size_t limit) {
    std::size_t end = std::min(limit, text.size());
    while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;
    std::string result = text.substr(0, end) + (end < text.size() ? "..." : "");
    for (char& c : result) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    }
    return result;
}

std::string object_path(ObjectId id, const scene::Object& object) {
    if (id == scene::RootId) return "root";
    const std::string group = scene::kind_row(kind(object)).plural;
    const std::string& given = name(object);
    return group + "/" + (given.empty() ? "@" + std::to_string(id.value) : shown(given, MaxName));
}

std::string summary(std::span<const scene::ObjectChange> changes) {
    std::vector<const scene::ObjectChange*> created, set, removed, linked;
    for (const scene::ObjectChange& change : changes) {
        if (!change.before) {
            created.push_back(&change);
        } else if (!change.after) {
            removed.push_back(&change);
        } else {
            (only_links(change) ? linked : set).push_back(&change);
        }
    }
    std::string text;
    append(text, "created", created);
    append(text, "set", set);
    append(text, "removed", removed);
    if (text.empty()) append(text, "set", linked);
    return text.empty() ? "no net change" : text;
}

std::string summary(const Transaction& transaction) {
    std::vector<scene::ObjectChange> changes;
    for (const auto& [id, change] : transaction.changes.all()) changes.push_back(change.object);
    return summary(changes);
}

}  // namespace tessera::master
