#pragma once

#include <string>
#include <utility>
#include <vector>

#include "client/import/import.h"

namespace tessera::import {

// Configuration of a scene, by the names in the file.
struct Configuration {
    std::vector<std::string> hidden;  // parts to remove: transforms, geometries or lights
    // Part (a geometry, or a transform with everything below it) and the name of its material.
    std::vector<std::pair<std::string, std::string>> materials;
};

// A name selects all objects that have it. InvalidInput: no such part or material; the message lists those
// there are.
Expected<void> configure(ImportedScene& scene, const Configuration& configuration);

}  // namespace tessera::import
