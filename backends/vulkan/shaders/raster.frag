#version 460
// Instance and triangle that are visible in a pixel. Alpha tests are those of rays.
#extension GL_GOOGLE_include_directive : require
#include "backends/vulkan/shaders/raster_draw.glsl"

// Features of the scene: other code is removed when the pipeline is compiled.
layout(constant_id = 1) const uint Features = 0xffffffffu;

layout(location = 0) flat in uvec2 ids;
layout(location = 0) out uvec2 seen;

bool stops(uvec2 pixel) {
    Scene scene = job.scene.items[0];
    scene.features = Features;
    if (scene.instances.items[ids.x].alpha_tested == 0u) return true;
    View view = job.view.items[0];
    const Ray ray = camera_ray(view, pixel.x, pixel.y, raster_place(view, job.index));
    const Hit hit = raster_hit(scene, ray, ids.x, ids.y);
    const Path path = start_path(make_sampler(pixel.x, pixel.y, view.seed, job.index));
    return stops_at(scene, skip_nothing(), hit.instance, hit.triangle, hit.barycentric, path_ray_numbers(path));
}

void main() {
    if ((Features & FeatureAlpha) != 0u) {
        if (!stops(uvec2(job.cell.x, job.cell.y) + uvec2(gl_FragCoord.xy))) discard;
    }
    seen = ids;
}
