#pragma once

#include <glm/mat4x4.hpp>
#include <map>

#include "client/import/scene_builder.h"

namespace tessera::import {

// What surfaces that glow are to a scene: its light, or mere labels and lamps that are seen. Files whose
// programs light nothing by them (glTF without KHR_materials_emissive_strength) have many of the latter.
class Glow {
  public:
    explicit Glow(SceneBuilder& builder) : builder_(builder) {}

    // A geometry that emits, as placed; counted again in each place.
    void place(ObjectId geometry, const glm::dmat4& world);

    // Whether it is light: some of it has a radiance above 1, which white paint cannot show; or a medium
    // glows; or all of it would give a sphere around the scene an irradiance of 0.2, in which white paint
    // shows 0.06. Textures count by their mean. Reads arrays of the builder.
    bool lights(const Bounds& scene) const;

  private:
    double area(const scene::Geometry& geometry) const;  // m^2, unplaced
    double power(ObjectId geometry) const;               // W per Rec. 709 luminance, unplaced

    SceneBuilder& builder_;
    std::map<ObjectId, double> placed_;  // geometries, with the sum of how much larger their areas became
};

}  // namespace tessera::import
