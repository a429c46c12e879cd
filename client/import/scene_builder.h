#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "client/import/import.h"
#include "client/import/mesh_data.h"

namespace tessera::import {

// Collects objects, blobs and notices while a file is read. Ids ascend in order of creation, names become
// unique per kind, equal arrays become one blob. Throws Error{InvalidInput} if ids or the budget of decoded
// bytes are exhausted.
class SceneBuilder {
  public:
    explicit SceneBuilder(const ImportOptions& options) : options_(options) {}

    const ImportOptions& options() const { return options_; }
    ImportedScene& result() { return result_; }

    // An empty name becomes "<kind> <number>"; one already taken by this kind gets ".2", ".3" and so on.
    ObjectId add(scene::Object object);
    template <class T>
    T& get(ObjectId id) {  // an added object; valid until the next add
        return std::get<T>(result_.objects[id.value - options_.first_id.value].object);
    }

    const scene::Object& object(ObjectId id) const {
        return result_.objects[id.value - options_.first_id.value].object;
    }

    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        return blob(std::as_bytes(std::span(values)));
    }
    scene::BlobRef blob(std::span<const std::byte> bytes);  // empty gives an empty reference
    const scene::Blob& stored(const scene::BlobRef& blob) const { return *blobs_.at(blob.hash); }

    // Adds an object as another builder with the same options has made it, in the order of ids; the root, too. Its
    // blobs are there already. Throws Error{InvalidInput} if it is not the next.
    void adopt(ObjectId id, scene::Object object);

    // Counts decoded bytes that do not become a blob.
    void spend(std::uint64_t bytes);

    // Adds and counts a mesh that passed check_and_repair.
    ObjectId add_geometry(std::string name, ObjectId material, const MeshData& mesh);

    // Placeholders for invalid data, created at first use: a magenta unit box at the origin, and a magenta
    // checkerboard.
    ObjectId placeholder_geometry();
    ObjectId placeholder_texture();

    // The file marks the light as one that casts no hard shadow.
    void mark_soft(ObjectId light) { soft_lights_.insert(light); }
    const std::set<ObjectId>& soft_lights() const { return soft_lights_; }

    void notice(const std::string& text);  // each once
    const Bounds& bounds(ObjectId geometry) const { return bounds_.at(geometry); }

  private:
    std::string unique_name(scene::ObjectKind kind, const std::string& wanted);

    const ImportOptions& options_;
    ImportedScene result_;
    std::set<std::pair<scene::ObjectKind, std::string>> names_;
    std::map<std::pair<scene::ObjectKind, std::string>, std::uint64_t> last_suffix_;
    std::map<scene::ObjectKind, std::uint64_t> added_;
    std::unordered_map<Hash256, scene::BlobPtr> blobs_;
    std::unordered_map<ObjectId, Bounds> bounds_;
    std::set<ObjectId> soft_lights_;
    std::set<std::string> notices_;
    std::uint64_t decoded_bytes_ = 0;
    ObjectId placeholder_geometry_, placeholder_texture_;
};

}  // namespace tessera::import
