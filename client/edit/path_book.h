#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/edit/words.h"
#include "mediator/scene/scene.h"

namespace tessera::edit {

std::string_view kind_word(scene::ObjectKind kind);  // "materials"; "root"
const std::vector<std::string>& kind_words();        // in the order of scene::Kinds
scene::ObjectKind read_kind(const Word& word);       // also "material"; throws ScriptError
bool is_kind(std::string_view word, scene::ObjectKind& kind);

// Which objects have which name; so that paths can be read and written. Kept in step by whoever changes the
// scene.
class PathBook {
  public:
    PathBook() = default;
    explicit PathBook(const scene::Scene& scene);

    void learn(ObjectId id, const scene::Object& object);
    void forget(ObjectId id, const scene::Object& object);

    // kind/name@id, and kind/name where no other object has it; "root" for the root, "none" for 0.
    std::string full_path(const scene::Scene& scene, ObjectId id) const;
    std::string path(const scene::Scene& scene, ObjectId id) const;

    // Throws ScriptError for what is no path, names nothing or several things.
    ObjectId read(const scene::Scene& scene, const Word& word) const;

    const std::map<std::string, std::set<ObjectId>>& names(scene::ObjectKind kind) const {
        static const std::map<std::string, std::set<ObjectId>> None;
        const auto place = names_.find(kind);
        return place == names_.end() ? None : place->second;
    }

  private:
    ObjectId read_id(const scene::Scene& scene, scene::ObjectKind kind, const Word& word,
                     std::size_t at) const;
    ObjectId read_name(const scene::Scene& scene, scene::ObjectKind kind, const Word& name) const;

    std::map<scene::ObjectKind, std::map<std::string, std::set<ObjectId>>> names_;
};

}  // namespace tessera::edit
