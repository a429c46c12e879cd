#!/usr/bin/env python3
"""Renders the reference pictures of cycles_test.cpp with Blender's Cycles, an independent renderer.

Usage: blender -b --factory-startup --python-exit-code 1 -P make_references.py -- ROOT [NAME ...]

For each scene (all, or the named ones) it writes tests/cycles/recorded/NAME.json: settings, and the mean radiance of
each block of 8 x 8 pixels with its standard error, from independent seeds. Scenes that are not in tests/scenes are
made here and written to tests/cycles/recorded/NAME.glb. All surfaces are Lambertian, without vertex normals. Debian's
blender and python3-numpy are enough; nothing else of Tessera needs them.
"""

import datetime
import json
import math
import os
import struct
import sys
import tempfile

import bpy
import numpy

numpy.bool = bool  # Blender 3.4's glTF add-on is older than NumPy 1.24

WIDTH, HEIGHT, BLOCK, BOUNCES = 96, 64, 8, 8
SAMPLES, SEEDS = 64, 16


def reset():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def material(name, color, emission=0.0):
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    shader = result.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1)
    shader.inputs["Roughness"].default_value = 1.0
    shader.inputs["Specular"].default_value = 0.0
    if emission:
        shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
        shader.inputs["Emission"].default_value = (*color, 1)
        shader.inputs["Emission Strength"].default_value = emission
    return result


def textured(name, path):
    result = material(name, (1, 1, 1))
    nodes = result.node_tree.nodes
    image = nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.load(path)
    result.node_tree.links.new(image.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return result


def paint(made):
    bpy.context.active_object.data.materials.append(made)
    return bpy.context.active_object


def plane(made, place=(0, 0, 0), size=10.0, turn=(0, 0, 0)):
    bpy.ops.mesh.primitive_plane_add(size=size, location=place, rotation=turn, calc_uvs=True)
    return paint(made)


def box(made, place, size, turn=0.0):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, rotation=(0, 0, turn))
    bpy.context.active_object.scale = size
    return paint(made)


def camera(place, target):
    bpy.ops.object.camera_add(location=place)
    made = bpy.context.active_object
    direction = [t - p for t, p in zip(target, place)]
    level = math.hypot(direction[0], direction[1])
    made.rotation_euler = (math.atan2(level, -direction[2]), 0, math.atan2(direction[1], direction[0]) - math.pi / 2)
    made.data.angle_y = 0.8
    made.data.sensor_fit = "VERTICAL"
    bpy.context.scene.camera = made


def ground_and_boxes():
    plane(material("ground", (0.6, 0.6, 0.6)))
    box(material("red", (0.7, 0.2, 0.1)), (-1, 0.4, 0.6), (0.8, 0.8, 1.2), 0.4)
    box(material("blue", (0.1, 0.3, 0.7)), (1.1, -0.3, 0.3), (1.2, 0.6, 0.6), -0.3)
    camera((0.3, -5, 3), (0, 0, 0.4))


def many_lamps():
    ground_and_boxes()
    for i in range(60):
        x, y = i % 10 - 4.5, i // 10 - 2.5
        color = [0.5 + 0.5 * math.cos(1.3 * i + k) for k in range(3)]
        plane(material(f"lamp {i}", color, 2.0 + i % 7), (0.7 * x, 0.9 * y, 1.6 + 0.2 * math.sin(i)), 0.12, (math.pi, 0, 0))


def textured_floor():
    pixels = numpy.random.default_rng(5).integers(20, 236, size=(8, 8, 3))
    path = os.path.join(tempfile.mkdtemp(), "floor.png")
    image = bpy.data.images.new("floor", 8, 8)
    values = numpy.ones((8, 8, 4))
    values[:, :, :3] = pixels / 255.0
    image.pixels = values.ravel()
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    bpy.data.images.remove(image)
    plane(textured("floor", path), size=6.0)
    box(material("white", (0.8, 0.8, 0.8)), (0.4, 0.5, 0.5), (1, 1, 1), 0.5)
    plane(material("lamp", (1, 0.9, 0.7), 6.0), (-1, 0, 3), 1.5, (math.pi, 0.3, 0))
    camera((0.3, -5, 3), (0, 0, 0.3))


def mirrored_instances():
    plane(material("ground", (0.5, 0.5, 0.5)))
    bpy.ops.mesh.primitive_cone_add(vertices=5, radius1=0.7, radius2=0.2, depth=1.2, location=(-1.2, 0, 0.6), rotation=(0.3, 0.2, 0))
    first = paint(material("cone", (0.8, 0.5, 0.2)))
    for i, scale in enumerate(((-1, 1, 1), (1, -1, 0.6), (-0.7, -0.9, -1))):
        copy = first.copy()
        copy.scale = scale
        copy.location = (0.4 + 0.9 * i - 0.4, 0.8 * (i - 1), 0.8)
        bpy.context.collection.objects.link(copy)
    plane(material("lamp", (1, 1, 1), 5.0), (-2, -2, 3), 2.0, (math.pi, -0.6, 0))
    camera((0.3, -5, 2.6), (0, 0, 0.5))


def sky_with_sides():
    plane(material("ground", (0.5, 0.5, 0.5)))
    box(material("white", (0.8, 0.8, 0.8)), (0, 0, 0.75), (1.5, 1.5, 1.5), 0.0)
    box(material("post", (0.7, 0.7, 0.7)), (-1.8, -1, 0.5), (0.3, 0.3, 1.0), 0.3)
    camera((2.6, -4.4, 3), (0, 0, 0.5))


def own_lights():
    """A lamp of each kind, an emissive panel and a grey sky, as Blender exports them."""
    ground_and_boxes()
    bpy.ops.object.light_add(type="SUN", rotation=(0.7, 0.2, 0.4))
    bpy.context.active_object.data.energy = 1.5
    bpy.context.active_object.data.angle = 0.0
    bpy.ops.object.light_add(type="POINT", location=(-0.3, -0.9, 1.1))
    bpy.context.active_object.data.energy = 40.0
    bpy.context.active_object.data.shadow_soft_size = 0.0
    bpy.ops.object.light_add(type="SPOT", location=(2, 1.5, 3), rotation=(0.4, 0.6, 0))
    spot = bpy.context.active_object.data
    # Narrow: Cycles 3.4 dims a spot by the cosine to its axis, which glTF's lights do not have.
    spot.energy, spot.spot_size, spot.spot_blend, spot.shadow_soft_size = 1000.0, 0.12, 0.0, 0.0
    plane(material("panel", (0.3, 0.6, 1.0), 3.0), (-2.2, 0.5, 1.5), 0.9, (0, 1.2, 0))


def left_out(path):
    """Names of nodes that Blender cannot read or that are not Lambertian: instancing, glass, punctual lights."""
    with open(path, "rb") as file:
        data = file.read()
    text = json.loads(data[20:20 + struct.unpack("<I", data[12:16])[0]])
    glass = {i for i, m in enumerate(text["materials"]) if "KHR_materials_transmission" in m.get("extensions", {})}
    names = []
    for node in text["nodes"]:
        mesh = text["meshes"][node["mesh"]] if "mesh" in node else {"primitives": []}
        is_glass = any(p.get("material") in glass for p in mesh["primitives"])
        extensions = node.get("extensions", {})
        if is_glass or "EXT_mesh_gpu_instancing" in extensions or "KHR_lights_punctual" in extensions:
            names.append(node["name"])
    return names


def make_lambertian():
    for made in bpy.data.materials:
        tree = made.node_tree
        for old in [node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"]:
            diffuse, emission, both = (tree.nodes.new("ShaderNode" + x) for x in ("BsdfDiffuse", "Emission", "AddShader"))
            for name, new in (("Base Color", diffuse.inputs["Color"]), ("Emission", emission.inputs["Color"]),
                              ("Emission Strength", emission.inputs["Strength"])):
                if old.inputs[name].links:
                    tree.links.new(old.inputs[name].links[0].from_socket, new)
                else:
                    new.default_value = old.inputs[name].default_value
            tree.links.new(diffuse.outputs[0], both.inputs[0])
            tree.links.new(emission.outputs[0], both.inputs[1])
            output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
            tree.links.new(both.outputs[0], output.inputs["Surface"])
        # Cycles interpolates sRGB bytes, not light.
        for image in [node for node in tree.nodes if node.type == "TEX_IMAGE"]:
            image.interpolation = "Closest"
    for mesh in bpy.data.meshes:
        mesh.use_auto_smooth = False
        if mesh.has_custom_normals:
            mesh.free_normals_split()
        for polygon in mesh.polygons:
            polygon.use_smooth = False


def set_world(background, environment):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    shader = world.node_tree.nodes["Background"]
    shader.inputs["Color"].default_value = (*background, 1)
    if environment:
        texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        texture.image = bpy.data.images.load(environment)
        world.node_tree.links.new(texture.outputs["Color"], shader.inputs["Color"])


def settings():
    render, cycles = bpy.context.scene.render, bpy.context.scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    bpy.context.scene.view_settings.view_transform = "Raw"
    cycles.device, cycles.samples = "CPU", SAMPLES
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = BOUNCES
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True


def block_means(seed):
    bpy.context.scene.cycles.seed = seed
    path = os.path.join(tempfile.mkdtemp(), "picture.exr")
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Linear"
    pixels = numpy.array(image.pixels[:], dtype=numpy.float64).reshape(HEIGHT, WIDTH, 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    return pixels.reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, 3).mean(axis=(1, 3)).reshape(-1, 3)


# Scene file or maker, background, environment.
SCENES = {
    "room": ("room-1.glb", (0.1, 0.1, 0.1), None),
    "interior": ("interior-1.glb", (0.2, 0.3, 0.5), None),
    "many-lamps": (many_lamps, (0, 0, 0), None),
    "textured-floor": (textured_floor, (0.02, 0.02, 0.02), None),
    "mirrored-instances": (mirrored_instances, (0.05, 0.05, 0.05), None),
    "sky": (sky_with_sides, (0, 0, 0), "env-noon.exr"),
    "blender-lights": (own_lights, (0.2, 0.2, 0.2), None),
}


def make(root, name):
    source, background, environment = SCENES[name]
    recorded = os.path.join(root, "tests/cycles/recorded")
    scenes = os.path.join(root, "tests/scenes")
    reset()
    names = []
    if isinstance(source, str):
        names = left_out(os.path.join(scenes, source))
        bpy.ops.import_scene.gltf(filepath=os.path.join(scenes, source))
        for found in [x for x in bpy.data.objects if x.name in names]:
            bpy.data.objects.remove(found)
        bpy.context.scene.camera = next(x for x in bpy.data.objects if x.type == "CAMERA" and x.name in ("room", "camera"))
    else:
        source()
        bpy.ops.export_scene.gltf(filepath=os.path.join(recorded, name + ".glb"), export_format="GLB", export_lights=True,
                                  export_cameras=True, export_normals=False, export_apply=True)
    make_lambertian()
    set_world(background, os.path.join(scenes, environment) if environment else None)
    settings()
    means = numpy.array([block_means(seed) for seed in range(SEEDS)])
    result = {
        "renderer": "Cycles of Blender " + bpy.app.version_string,
        "date": datetime.date.today().isoformat(),
        "scene": source if isinstance(source, str) else name + ".glb",
        "camera": bpy.context.scene.camera.name,
        "background": background,
        "environment": environment or "",
        "left_out": names,
        "width": WIDTH, "height": HEIGHT, "block": BLOCK, "bounces": BOUNCES, "samples": SAMPLES, "seeds": SEEDS,
        "means": [[float(f"{x:.7g}") for x in block] for block in means.mean(axis=0)],
        "errors": [[float(f"{x:.3g}") for x in block] for block in means.std(axis=0, ddof=1) / math.sqrt(SEEDS)],
    }
    with open(os.path.join(recorded, name + ".json"), "w", encoding="utf-8") as file:
        json.dump(result, file)
        file.write("\n")
    print(name, "mean", means.mean(), "median error", numpy.median(result["errors"]) / means.mean())


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    for name in arguments[1:] or SCENES:
        make(arguments[0], name)


main()
