#pragma once

#include <glm/mat4x4.hpp>
#include <map>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Decides whether emissive surfaces light a scene or are just visible, like labels and displays. glTF files
// without KHR_materials_emissive_strength have many of the latter, as rasterizers do not light a scene by
// them.
class EmissiveLights {
  public:
    explicit EmissiveLights(SceneBuilder& builder) : builder_(builder) {}

    // Adds one instance of an emissive geometry.
    void add(ObjectId geometry, const glm::dmat4& world);

    // True if some radiance is above 1; or a medium emits; or the total power gives a sphere around the scene
    // an irradiance of at least 0.2 (white paint then has a radiance of 0.06). Textures count by their mean.
    // Reads arrays of the builder.
    bool are_significant(const Bounds& scene) const;

  private:
    double area(const scene::Geometry& geometry) const;  // m^2, in local space
    double power(ObjectId geometry) const;               // W, Rec. 709 luminance, in local space

    SceneBuilder& builder_;
    std::map<ObjectId, double>
        area_scales_;  // sum over instances of the factor by which the transform scales areas
};

}  // namespace tessera::import
