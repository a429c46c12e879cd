#include "client/edit/path_index.h"

#include <charconv>

#include "client/edit/script_error.h"
#include "mediator/base/nearest.h"

namespace tessera::edit {
namespace {

using scene::ObjectKind;

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    const auto best = nearest(word, candidates);
    return best ? "; did you mean '" + *best + "'?" : "";
}

}  // namespace

const std::vector<std::string>& kind_words() {
    static const std::vector<std::string> Words = [] {
        std::vector<std::string> words;
        for (const scene::KindRow& row : scene::Kinds) words.emplace_back(row.plural);
        return words;
    }();
    return Words;
}

std::string_view kind_word(ObjectKind kind) {
    return scene::kind_row(kind).plural;
}

bool is_kind(std::string_view word, ObjectKind& kind) {
    for (const scene::KindRow& row : scene::Kinds) {
        if (word != row.plural && word != row.name) continue;
        kind = row.kind;
        return true;
    }
    return false;
}

ObjectKind read_kind(const Word& word) {
    ObjectKind kind{};
    if (is_kind(word.text(), kind)) return kind;
    std::string all;
    for (const std::string& one : kind_words()) all += (all.empty() ? "" : ", ") + one;
    const std::string nearest = did_you_mean(word.text(), kind_words());
    throw ScriptError(word.column(), "there is no kind of object '" + word.text() + "'" +
                                         (nearest.empty() ? "; kinds are " + all : nearest));
}

PathIndex::PathIndex(const scene::Scene& scene) {
    for (const auto& [id, object] : scene.objects()) add(id, *object);
}

void PathIndex::add(ObjectId id, const scene::Object& object) {
    names_[scene::kind(object)][scene::name(object)].insert(id);
}

void PathIndex::remove(ObjectId id, const scene::Object& object) {
    auto& names = names_[scene::kind(object)];
    const auto place = names.find(scene::name(object));
    if (place == names.end()) return;
    place->second.erase(id);
    if (place->second.empty()) names.erase(place);
}

std::string PathIndex::full_path(const scene::Scene& scene, ObjectId id) const {
    if (!id) return "none";
    if (id == scene::RootId) return "root";
    const scene::Object* object = scene.find(id);
    if (object == nullptr) return "@" + std::to_string(id.value) + " (missing)";
    const std::string& name = scene::name(*object);
    return std::string(kind_word(scene::kind(*object))) + "/" + (name.empty() ? "" : in_quotes(name)) + "@" +
           std::to_string(id.value);
}

std::string PathIndex::path(const scene::Scene& scene, ObjectId id) const {
    const scene::Object* object = scene.find(id);
    if (object == nullptr || id == scene::RootId || scene::name(*object).empty()) return full_path(scene, id);
    const auto& known = names(scene::kind(*object));
    const auto place = known.find(scene::name(*object));
    if (place == known.end() || place->second.size() != 1) return full_path(scene, id);
    return std::string(kind_word(scene::kind(*object))) + "/" + in_quotes(scene::name(*object));
}

ObjectId PathIndex::read(const scene::Scene& scene, const Word& word) const {
    const std::size_t slash = word.find('/');
    const Word kind_part = word.part(0, slash);
    if (slash == Word::None) {
        if (word.is("root")) return scene::RootId;
        ObjectKind kind{};
        const bool has_kind = is_kind(word.text(), kind);
        throw ScriptError(word.column(),
                          has_kind
                              ? "'" + word.text() + "' is a kind of object: write " + word.text() + "/NAME"
                              : "'" + word.text() + "' is not a path: write KIND/NAME, as in materials/red");
    }
    const ObjectKind kind = read_kind(kind_part);
    if (kind == ObjectKind::Root) return scene::RootId;
    const std::size_t at = word.rfind('@');
    if (at != Word::None && at > slash) return read_id(scene, kind, word, at);
    const Word name = word.part(slash + 1);
    if (name.empty() && !word.is_quoted()) {
        throw ScriptError(word.column(), "'" + word.text() + "' has no name: unnamed objects are written " +
                                             std::string(kind_word(kind)) + "/@ID");
    }
    return read_name(scene, kind, name);
}

ObjectId PathIndex::read_id(const scene::Scene& scene, ObjectKind kind, const Word& word,
                            std::size_t at) const {
    const Word digits = word.part(at + 1);
    std::uint64_t value = 0;
    const char* end = digits.text().data() + digits.text().size();
    const auto parsed = std::from_chars(digits.text().data(), end, value);
    if (digits.empty() || parsed.ec != std::errc() || parsed.ptr != end) {
        throw ScriptError(
            digits.column(),
            "'@" + digits.text() + "' is not an id: write a number, or quote names that contain @");
    }
    const scene::Object* object = scene.find(ObjectId{value});
    if (object == nullptr) {
        throw ScriptError(word.column(), "there is no object " + std::to_string(value) +
                                             ": it was removed or never existed; see 'list " +
                                             std::string(kind_word(kind)) + "'");
    }
    if (scene::kind(*object) != kind) {
        throw ScriptError(word.column(), "object " + std::to_string(value) + " is " +
                                             full_path(scene, ObjectId{value}) + ", not one of the " +
                                             std::string(kind_word(kind)));
    }
    return ObjectId{value};
}

ObjectId PathIndex::read_name(const scene::Scene& scene, ObjectKind kind, const Word& name) const {
    const auto& known = names(kind);
    const auto place = known.find(name.text());
    if (place == known.end()) {
        std::vector<std::string> candidates;
        for (const auto& [candidate, unused] : known) candidates.push_back(candidate);
        const std::string nearest = did_you_mean(name.text(), candidates);
        throw ScriptError(
            name.column(),
            "there is no '" + name.text() + "' among the " + std::string(kind_word(kind)) +
                (nearest.empty() ? ": see 'list " + std::string(kind_word(kind)) + "'" : nearest));
    }
    if (place->second.size() == 1) return *place->second.begin();
    constexpr std::size_t Most = 8;
    std::string all;
    std::size_t count = 0;
    for (const ObjectId id : place->second) {
        if (count++ == Most) break;
        all += (all.empty() ? "" : ", ") + full_path(scene, id);
    }
    if (place->second.size() > Most) all += ", ...";
    throw ScriptError(name.column(), std::to_string(place->second.size()) + " " +
                                         std::string(kind_word(kind)) + " are named '" + name.text() +
                                         "': choose one of " + all);
}

}  // namespace tessera::edit
