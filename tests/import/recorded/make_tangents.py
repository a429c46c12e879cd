"""Writes meshes with tangents as Blender makes them (MikkTSpace), for tests/import/tangents_test.cpp.

Usage: blender -b -P make_tangents.py -- mikktspace.glb
"""
import math
import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)


def finish(name, smooth=True):
    mesh_object = bpy.context.active_object
    mesh_object.name = mesh_object.data.name = name
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.quads_convert_to_tris()
    bpy.ops.object.mode_set(mode="OBJECT")
    for polygon in mesh_object.data.polygons:
        polygon.use_smooth = smooth
    return mesh_object


bpy.ops.mesh.primitive_monkey_add(calc_uvs=True)
monkey = finish("monkey")
modifier = monkey.modifiers.new("decimate", "DECIMATE")
modifier.ratio = 0.4
bpy.ops.object.modifier_apply(modifier="decimate")
bpy.ops.mesh.primitive_uv_sphere_add(segments=10, ring_count=6, calc_uvs=True)
finish("sphere")
bpy.ops.mesh.primitive_torus_add(major_segments=9, minor_segments=5, generate_uvs=True)
finish("torus")
bpy.ops.mesh.primitive_cone_add(vertices=7, calc_uvs=True)
finish("cone", smooth=False)
# Both halves have the same part of the texture, one of them mirrored.
bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=4, calc_uvs=True)
fold = finish("fold")
for vertex in fold.data.vertices:
    vertex.co.z = 0.4 * abs(vertex.co.x) + 0.2 * math.sin(3.0 * vertex.co.y)
for loop in fold.data.uv_layers[0].data:
    loop.uv.x = abs(loop.uv.x - 0.5)
bpy.ops.export_scene.gltf(filepath=sys.argv[-1], export_format="GLB", export_tangents=True,
                          export_materials="NONE")
