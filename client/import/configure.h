#pragma once

#include <string>
#include <utility>
#include <vector>

#include "client/import/import.h"

namespace tessera::import {

// What a configurator chooses in a scene, by the names in the file.
struct Configuration {
    std::vector<std::string> hidden;  // parts that are left out: transforms, geometries or lights
    // Part (a geometry, or a transform with everything below it) and the name of its material.
    std::vector<std::pair<std::string, std::string>> materials;
};

// A name means every object that has it. InvalidInput: no such part or material; the message names the
// nearest ones.
Expected<void> configure(ImportedScene& scene, const Configuration& configuration);

}  // namespace tessera::import
