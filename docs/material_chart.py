#!/usr/bin/env python3
"""Writes the scenes of the README's material charts: rows of spheres before a checker, one feature a row.

material_chart.py FOLDER writes materials-1.gltf, ... and surface-shaders-1.x3d, ..., of four rows each, and prints
a line for each: its name and its number of rows. docs/make_pictures.sh renders them. A row is a line in ROWS or
SHADER_ROWS: eight materials from left to right, or pairs of one and another one inside of it. The cameras look at
all rows of a scene.
"""

import base64
import json
import math
import os
import struct
import sys

COLUMNS, MOST_ROWS = 8, 4
STEPS = [i / (COLUMNS - 1) for i in range(COLUMNS)]
DISTANCE = 2.3  # of the spheres' centres, in radii
BACK = -1.6     # of the checker


def pbr(color=(1, 1, 1), metallic=0.0, roughness=0.5, **extensions):
    material = {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": metallic,
                                         "roughnessFactor": roughness}}
    if extensions:
        material["extensions"] = {f"KHR_materials_{name}": fields for name, fields in extensions.items()}
    return material


def glass(roughness=0.0, color=(1, 1, 1), ior=1.5, iridescence=None, **volume):
    extensions = {"transmission": {"transmissionFactor": 1}, "ior": {"ior": ior}}
    if iridescence:
        extensions["iridescence"] = iridescence
    if volume:
        extensions["volume"] = volume
    return pbr(color, 0.0, roughness, **extensions)


GOLD, RED, CLOTH = (1.0, 0.77, 0.34), (0.6, 0.05, 0.04), (0.15, 0.02, 0.08)

ROWS = [
    ("metal, roughness 0 to 1", [pbr(GOLD, 1, r) for r in STEPS]),
    ("dielectric, roughness 0 to 1", [pbr(RED, 0, r) for r in STEPS]),
    ("dielectric, index of refraction 1 to 2.4, roughness 0.1",
     [pbr(RED, 0, 0.1, ior={"ior": 1 + 1.4 * s}) for s in STEPS]),
    ("clearcoat 0 to 1 over rough metal",
     [pbr((0.05, 0.12, 0.45), 0.8, 0.6, clearcoat={"clearcoatFactor": s, "clearcoatRoughnessFactor": 0.04})
      for s in STEPS]),
    ("sheen, roughness 0.1 to 1, over cloth",
     [pbr(CLOTH, 0, 1, sheen={"sheenColorFactor": [0.7, 0.45, 0.6], "sheenRoughnessFactor": 0.1 + 0.9 * s})
      for s in STEPS]),
    ("anisotropy 0 to 1 of metal with roughness 0.4",
     [pbr((0.9, 0.91, 0.92), 1, 0.4, anisotropy={"anisotropyStrength": s, "anisotropyRotation": 0.0})
      for s in STEPS]),
    ("glass with thin walls, roughness 0 to 0.7, the last four blue",
     [glass(0.7 * s, (1, 1, 1) if s < 0.5 else (0.25, 0.5, 1)) for s in STEPS]),
    ("glass bodies, roughness 0 to 0.7, the last four amber inside",
     [glass(0.7 * s, thicknessFactor=1, **({} if s < 0.5 else {"attenuationDistance": 0.8,
                                                               "attenuationColor": [1, 0.55, 0.12]}))
      for s in STEPS]),
    ("iridescence of dark lacquer, film of 100 to 800 nm",
     [pbr((0.02, 0.02, 0.02), 0, 0.05,
          iridescence={"iridescenceFactor": 1, "iridescenceThicknessMaximum": 100 + 700 * s}) for s in STEPS]),
    ("iridescence of bubbles, index of the film 1.1 to 1.6",
     [glass(iridescence={"iridescenceFactor": 1, "iridescenceIor": 1.1 + 0.5 * s, "iridescenceThicknessMaximum": 500})
      for s in STEPS]),
    ("solids of index 1 to 2.4 inside glass of index 1.5",
     [(glass(thicknessFactor=1), glass(ior=1 + 1.4 * s, thicknessFactor=1)) for s in STEPS]),
]
INNER = 0.65  # radius of a solid inside another one


def sphere(rings=48, sectors=96):
    """Positions (also the normals), tangents east, texture coordinates, and triangles of a unit sphere."""
    points, tangents, coordinates, triangles = [], [], [], []
    for i in range(rings + 1):
        for j in range(sectors + 1):
            polar, azimuth = math.pi * i / rings, 2 * math.pi * j / sectors
            points.append((math.sin(polar) * math.sin(azimuth), math.cos(polar), math.sin(polar) * math.cos(azimuth)))
            tangents.append((math.cos(azimuth), 0, -math.sin(azimuth), 1))
            coordinates.append((j / sectors, i / rings))
    for i in range(rings):
        for j in range(sectors):
            a = i * (sectors + 1) + j
            b = a + sectors + 1
            triangles += [a, b, a + 1] if i > 0 else []
            triangles += [a + 1, b, b + 1] if i < rings - 1 else []
    return points, tangents, coordinates, triangles


def checker(rows):
    """Squares half a sphere's distance wide, of two greys by turns: positions and triangles of each grey."""
    across, high = COLUMNS * DISTANCE, rows * DISTANCE
    edge = DISTANCE / 2
    greys = ([], []), ([], [])
    for i in range(-2, 2 * COLUMNS + 2):
        for j in range(-2, 2 * rows + 2):
            points, triangles = greys[(i + j) % 2]
            x, y, first = i * edge - across / 2, j * edge - high / 2, len(points)
            points += [(x, y, BACK), (x + edge, y, BACK), (x + edge, y + edge, BACK), (x, y + edge, BACK)]
            triangles += [first, first + 1, first + 2, first, first + 2, first + 3]
    return greys


# Emissive panels that face the centre, in radii: position, width, height, radiance.
PANELS = [((-42, 38, 42), 36, 36, 8.0), ((56, 7, 35), 16, 44, 1.5)]
FACES = [0, 1, 2, 0, 2, 3]


def panel(position, width, height):
    """Corners of a rectangle that faces the origin."""
    length = math.sqrt(sum(x * x for x in position))
    back = [-x / length for x in position]
    right = (back[2], 0, -back[0])
    size = math.hypot(*right)
    right = [x / size for x in right]
    up = (back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
          back[0] * right[1] - back[1] * right[0])
    return [tuple(position[k] + width / 2 * a * right[k] + height / 2 * b * up[k] for k in range(3))
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def place(row, column, rows):
    return ((column - (COLUMNS - 1) / 2) * DISTANCE, ((rows - 1) / 2 - row) * DISTANCE, 0)


def eye(rows, fov):
    """How far the camera stands, for all rows to fill the picture's height."""
    return rows * DISTANCE / 2 / math.tan(fov / 2) + 1


class Gltf:
    """Collects arrays in one buffer."""

    def __init__(self):
        self.buffer = bytearray()
        self.views, self.accessors = [], []

    def add(self, values, kind, code="f", component=5126):
        flat = [x for value in values for x in value] if kind != "SCALAR" else values
        data = struct.pack(f"<{len(flat)}{code}", *flat)
        self.views.append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data)})
        self.buffer += data
        accessor = {"bufferView": len(self.views) - 1, "componentType": component, "type": kind, "count": len(values)}
        if kind == "VEC3":
            accessor["min"] = [min(v[k] for v in values) for k in range(3)]
            accessor["max"] = [max(v[k] for v in values) for k in range(3)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def indices(self, triangles):
        return self.add(triangles, "SCALAR", "I", 5125)


def write_gltf(path, rows):
    file = Gltf()
    points, tangents, coordinates, triangles = sphere()
    position = file.add(points, "VEC3")
    attributes = {"POSITION": position, "NORMAL": position, "TANGENT": file.add(tangents, "VEC4"),
                  "TEXCOORD_0": file.add(coordinates, "VEC2")}
    order = file.indices(triangles)
    materials, meshes, nodes = [], [], []
    for grey, (corners, faces) in zip((0.1, 0.3), checker(len(rows))):
        materials.append({"name": f"grey {grey}", **pbr((grey, grey, grey), 0, 1)})
        meshes.append({"primitives": [{"attributes": {"POSITION": file.add(corners, "VEC3")},
                                       "indices": file.indices(faces), "material": len(materials) - 1}]})
        nodes.append({"mesh": len(meshes) - 1})
    for position, width, height, radiance in PANELS:
        materials.append({"name": "panel", "emissiveFactor": [1, 1, 1],
                          "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": radiance}}})
        meshes.append({"primitives": [{"attributes": {"POSITION": file.add(panel(position, width, height), "VEC3")},
                                       "indices": file.indices(FACES), "material": len(materials) - 1}]})
        nodes.append({"mesh": len(meshes) - 1})
    for row, (name, looks) in enumerate(rows):
        for column, look in enumerate(looks):
            for depth, body in enumerate(look if isinstance(look, tuple) else (look,)):
                materials.append({"name": f"{name}: {column}", **body})
                meshes.append({"primitives": [{"attributes": attributes, "indices": order,
                                               "material": len(materials) - 1}]})
                nodes.append({"mesh": len(meshes) - 1, "translation": place(row, column, len(rows)),
                              "scale": [INNER ** depth] * 3})
    fov = 0.35
    nodes.append({"camera": 0, "translation": [0, 0, eye(len(rows), fov)]})
    used = sorted({name for material in materials for name in material.get("extensions", {})})
    json.dump({
        "asset": {"version": "2.0", "generator": "docs/material_chart.py"}, "extensionsUsed": used,
        "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes, "materials": materials,
        "cameras": [{"type": "perspective", "perspective": {"yfov": fov, "znear": 0.1}}],
        "accessors": file.accessors, "bufferViews": file.views,
        "buffers": [{"byteLength": len(file.buffer),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(file.buffer).decode()}],
    }, open(path, "w"))


def shader(**fields):
    values = {name: " ".join(map(str, value)) if isinstance(value, tuple) else value for name, value in fields.items()}
    return "<CommonSurfaceShader " + " ".join(f"{name}='{value}'" for name, value in values.items()) + "/>"


def volume(**fields):
    return shader(**fields).replace("CommonSurfaceShader", "CommonVolumeShader")


WHITE, BLACK = (1, 1, 1), (0, 0, 0)

SHADER_ROWS = [
    ("glossy, shininess 0 to 1",
     [shader(diffuseFactor=(0.3, 0.02, 0.02), specularFactor=(0.5, 0.5, 0.5), shininessFactor=s) for s in STEPS]),
    ("glossy along one axis, shininess 0.1 and 0.1 to 8",
     [shader(diffuseFactor=BLACK, specularFactor=(0.8, 0.8, 0.8), shininessFactor=(0.1, 0.1 * 80 ** s)) for s in STEPS]),
    ("perfect reflection of index 1.5, fresnelBlend 0 to 1",
     [shader(diffuseFactor=(0.02, 0.1, 0.02), reflectionFactor=WHITE, relativeIndexOfRefraction=1.5,
             fresnelBlend=s) for s in STEPS]),
    ("perfect transmission, index 1 to 2",
     [shader(diffuseFactor=BLACK, reflectionFactor=WHITE, transmissionFactor=WHITE,
             relativeIndexOfRefraction=1 + s) for s in STEPS]),
    ("dispersion: red refracts less than blue",
     [shader(diffuseFactor=BLACK, reflectionFactor=WHITE, transmissionFactor=WHITE,
             relativeIndexOfRefraction=(1.5 - 0.2 * s, 1.5, 1.5 + 0.2 * s)) for s in STEPS]),
    ("alpha 1 to 0",
     [shader(diffuseFactor=(0.1, 0.3, 0.6), specularFactor=(0.3, 0.3, 0.3), shininessFactor=0.8, alphaFactor=1 - s)
      for s in STEPS]),
    ("media without a surface: scattering 0.3 to 30 per metre",
     [volume(scatteringFactor=tuple(k * 100 ** s for k in (0.3, 0.27, 0.2)), absorptionFactor=(0.01, 0.02, 0.05))
      for s in STEPS]),
    ("glass filled with a medium: absorption 0.1 to 10 per metre, the last four emit light",
     [shader(diffuseFactor=BLACK, reflectionFactor=WHITE, transmissionFactor=WHITE, relativeIndexOfRefraction=1.5)
      + volume(absorptionFactor=tuple(k * 100 ** s for k in (0.1, 0.02, 0.06)),
               emissionFactor=BLACK if s < 0.5 else (0.1, 0.5, 0.2)) for s in STEPS]),
]


def x3d_mesh(material, corners, faces):
    return (f"<Shape><Appearance><Material {material}/></Appearance>"
            f"<IndexedTriangleSet index='{' '.join(map(str, faces))}'>"
            f"<Coordinate point='{', '.join('%g %g %g' % corner for corner in corners)}'/>"
            "</IndexedTriangleSet></Shape>")


def write_x3d(path, rows):
    shapes = []
    for grey, (corners, faces) in zip((0.1, 0.3), checker(len(rows))):
        shapes.append(x3d_mesh(f"diffuseColor='{grey} {grey} {grey}'", corners, faces))
    for position, width, height, radiance in PANELS:
        shapes.append(x3d_mesh(f"diffuseColor='0 0 0' emissiveColor='{radiance} {radiance} {radiance}'",
                               panel(position, width, height), FACES))
    for row, (_, looks) in enumerate(rows):
        for column, look in enumerate(looks):
            at = " ".join(f"{x:g}" for x in place(row, column, len(rows)))
            shapes.append(f"<Transform translation='{at}'><Shape><Appearance>{look}</Appearance><Sphere/></Shape></Transform>")
    fov = 0.35
    with open(path, "w") as file:
        file.write("<X3D profile='Interchange' version='3.3'><Scene>\n"
                   f"<Viewpoint fieldOfView='{fov}' position='0 0 {eye(len(rows), fov):g}'/>\n"
                   + "\n".join(shapes) + "\n</Scene></X3D>\n")


def main():
    folder = sys.argv[1] if len(sys.argv) == 2 else sys.exit(__doc__)
    os.makedirs(folder, exist_ok=True)
    for name, suffix, write, rows in (("materials", "gltf", write_gltf, ROWS),
                                      ("surface-shaders", "x3d", write_x3d, SHADER_ROWS)):
        for first in range(0, len(rows), MOST_ROWS):
            file, some = f"{name}-{first // MOST_ROWS + 1}.{suffix}", rows[first:first + MOST_ROWS]
            write(os.path.join(folder, file), some)
            print(file, len(some))


if __name__ == "__main__":
    main()
