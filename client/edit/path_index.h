#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/edit/tokenizer.h"
#include "mediator/scene/scene.h"

namespace tessera::edit {

std::string_view kind_word(scene::ObjectKind kind);  // "materials"; "root"
const std::vector<std::string>& kind_words();        // in the order of scene::Kinds
scene::ObjectKind read_kind(const Word& word);       // also "material"; throws ScriptError
bool is_kind(std::string_view word, scene::ObjectKind& kind);

// Maps object names to ids, to read and write paths. Code that changes the scene must update it.
class PathIndex {
  public:
    PathIndex() = default;
    explicit PathIndex(const scene::Scene& scene);

    void add(ObjectId id, const scene::Object& object);
    void remove(ObjectId id, const scene::Object& object);

    // full_path: kind/name@id. path: kind/name if the name is unique. "root" for the root, "none" for 0.
    std::string full_path(const scene::Scene& scene, ObjectId id) const;
    std::string path(const scene::Scene& scene, ObjectId id) const;

    // Throws ScriptError if the word is not a path, or names no object or several.
    ObjectId read(const scene::Scene& scene, const Word& word) const;

    const std::map<std::string, std::set<ObjectId>>& names(scene::ObjectKind kind) const {
        static const std::map<std::string, std::set<ObjectId>> None;
        const auto it = names_.find(kind);
        return it == names_.end() ? None : it->second;
    }

  private:
    ObjectId read_id(const scene::Scene& scene, scene::ObjectKind kind, const Word& word,
                     std::size_t at) const;
    ObjectId read_name(const scene::Scene& scene, scene::ObjectKind kind, const Word& name) const;

    std::map<scene::ObjectKind, std::map<std::string, std::set<ObjectId>>> names_;
};

}  // namespace tessera::edit
