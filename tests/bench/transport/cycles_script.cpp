#include "tests/bench/transport/cycles_script.h"

namespace tessera::tools::bench {

std::string_view cycles_script() {
    return R"(# blender -b --factory-startup -P SCRIPT -- JOB.json: renders a glTF scene, once for each pair of samples and seed.
import json
import sys
import time

import bpy
import numpy

numpy.bool = bool  # the glTF add-on of Blender 3.4 is older than NumPy 1.24

with open(sys.argv[sys.argv.index("--") + 1]) as file:
    job = json.load(file)
bpy.ops.wm.read_factory_settings(use_empty=True)
started = time.perf_counter()
bpy.ops.import_scene.gltf(filepath=job["scene"])
import_seconds = time.perf_counter() - started

scene = bpy.context.scene
scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
world = bpy.data.worlds.new("world")
scene.world = world
world.use_nodes = True
background = world.node_tree.nodes["Background"]
background.inputs["Color"].default_value = (*job["background"], 1)
if job["environment"]:
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(job["environment"])
    world.node_tree.links.new(background.inputs["Color"], texture.outputs["Color"])

render, cycles = scene.render, scene.cycles
render.engine = "CYCLES"
render.resolution_x, render.resolution_y, render.resolution_percentage = job["width"], job["height"], 100
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.threads_mode, render.threads = "FIXED", job["threads"]
render.use_persistent_data = True  # the BVH is not built anew for each picture
scene.view_settings.view_transform = "Raw"
cycles.device = "CPU"
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = job["bounces"]
cycles.transparent_max_bounces = 64
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
cycles.light_sampling_threshold = cycles.blur_glossy = 0
cycles.caustics_reflective = cycles.caustics_refractive = True

results = {"import_seconds": import_seconds, "pictures": []}
for spp, seed, path in job["pictures"]:
    cycles.samples, cycles.seed, render.filepath = spp, seed, path
    started = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    results["pictures"].append(time.perf_counter() - started)
    with open(job["results"], "w") as file:
        json.dump(results, file)
)";
}

}  // namespace tessera::tools::bench
