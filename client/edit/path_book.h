#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/edit/words.h"
#include "mediator/scene/scene.h"

namespace tessera::edit {

inline constexpr std::size_t KindCount = std::variant_size_v<scene::Object>;

std::string_view kind_word(scene::ObjectKind kind);  // "materials"; "root"
const std::vector<std::string>& kind_words();        // in the order of ObjectKind
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
        return names_[static_cast<std::size_t>(kind)];
    }

  private:
    ObjectId read_id(const scene::Scene& scene, scene::ObjectKind kind, const Word& word,
                     std::size_t at) const;
    ObjectId read_name(const scene::Scene& scene, scene::ObjectKind kind, const Word& name) const;

    std::array<std::map<std::string, std::set<ObjectId>>, KindCount> names_;
};

}  // namespace tessera::edit
