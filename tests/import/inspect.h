#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "client/import/import.h"
#include "mediator/scene/objects.h"

// Helpers to inspect imported scenes.
namespace tessera::import {

// Fails the test with the error's message and returns an empty scene.
inline ImportedScene loaded(const std::filesystem::path& file, const ImportOptions& options = {}) {
    Expected<ImportedScene> scene = import_scene(file, options);
    if (scene) return std::move(*scene);
    ADD_FAILURE() << scene.error().what();
    return {};
}

template <class T>
std::vector<const T*> all(const ImportedScene& scene) {
    std::vector<const T*> found;
    for (const scene::Create& create : scene.objects) {
        if (const T* object = std::get_if<T>(&create.object)) found.push_back(object);
    }
    return found;
}

template <class T>
const T& named(const ImportedScene& scene, const std::string& name) {
    for (const T* object : all<T>(scene)) {
        if (object->name == name) return *object;
    }
    ADD_FAILURE() << "no object is named " << name;
    static const T none{};
    return none;
}

template <class T>
const T& object(const ImportedScene& scene, ObjectId id) {
    for (const scene::Create& create : scene.objects) {
        if (create.id == id) return std::get<T>(create.object);
    }
    ADD_FAILURE() << "no object has the id " << id.value;
    static const T none{};
    return none;
}

template <class T>
std::vector<T> values(const ImportedScene& scene, const scene::BlobRef& reference) {
    for (const scene::BlobPtr& blob : scene.blobs) {
        if (blob->hash() == reference.hash) {
            const auto span = blob->as<T>();
            return {span.begin(), span.end()};
        }
    }
    EXPECT_TRUE(reference.empty()) << "a blob is missing";
    return {};
}

inline testing::AssertionResult has_notice(const ImportedScene& scene, const std::string& part) {
    std::string seen;
    for (const std::string& notice : scene.notices) {
        if (notice.find(part) != std::string::npos) return testing::AssertionSuccess();
        seen += "\n  " + notice;
    }
    return testing::AssertionFailure() << "no notice says '" << part << "'; there are:" << seen;
}

// Invariants of imported scenes: consecutive ids, unique names, existing blobs of the right size, references
// to existing objects, indices in range.
void expect_consistent(const ImportedScene& scene, const ImportOptions& options = {});

// Checks the scene as a master and its nodes do.
void expect_valid(const ImportedScene& imported);

}  // namespace tessera::import
