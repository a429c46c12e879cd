"""The kinds of scene objects, as values. Field names and meanings are those of mediator/scene/objects.h: metres,
radians, linear Rec. 709; world right-handed, y up; matrices column by column. References are object ids, 0 = none."""

from __future__ import annotations

from dataclasses import dataclass

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Vec4 = tuple[float, float, float, float]
Matrix = tuple[float, ...]  # 16 numbers, column by column

IDENTITY: Matrix = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
ROOT_ID = 1


@dataclass(frozen=True)
class Blob:
    """Immutable bytes by name; what they are is told by `Scene.bytes_of`."""

    hash: bytes = b""  # BLAKE2b-256
    byte_size: int = 0  # 0 = nothing there


@dataclass(frozen=True)
class TextureSlot:
    """A texture as a material uses it: uv' = translate(offset) rotate(rotation) scale(scale) uv."""

    texture: int = 0
    offset: Vec2 = (0.0, 0.0)
    scale: Vec2 = (1.0, 1.0)
    rotation: float = 0.0


@dataclass(frozen=True)
class Object:
    """What all kinds have. A value: it stays as it was read; ask the scene again for newer ones."""

    id: int
    name: str = ""


@dataclass(frozen=True)
class Root(Object):
    children: tuple[int, ...] = ()
    background: int = 0
    render_origin: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Transform(Object):
    matrix: Matrix = IDENTITY  # parent from local
    children: tuple[int, ...] = ()
    hint: str = "unflagged"
    layers: int = 0  # bit i: what hangs below is in layer i; 0 = as the parent says


@dataclass(frozen=True)
class Geometry(Object):
    material: int = 0
    hint: str = "unflagged"
    indices: Blob = Blob()  # uint32 x 3 per triangle
    positions: Blob = Blob()  # float32 x 3 per vertex
    normals: Blob = Blob()  # float32 x 3 per vertex
    tangents: Blob = Blob()  # float32 x 4 per vertex
    tex_coords: Blob = Blob()  # float32 x 2 per vertex
    colors: Blob = Blob()  # float32 x 4 per vertex


@dataclass(frozen=True)
class Material(Object):
    base_color: Vec4 = (0.8, 0.8, 0.8, 1.0)
    base_color_texture: TextureSlot = TextureSlot()
    metallic: float = 0.0
    roughness: float = 1.0
    metallic_roughness_texture: TextureSlot = TextureSlot()
    normal_texture: TextureSlot = TextureSlot()
    normal_scale: float = 1.0
    emission: Vec3 = (0.0, 0.0, 0.0)
    emission_texture: TextureSlot = TextureSlot()
    alpha_mode: str = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False
    index_of_refraction: float = 1.5
    transmission: float = 0.0


@dataclass(frozen=True)
class Texture(Object):
    width: int = 0
    height: int = 0
    format: str = "rgba8"
    wrap_s: str = "repeat"
    wrap_t: str = "repeat"
    filter: str = "linear"
    texels: Blob = Blob()  # rows from the top


@dataclass(frozen=True)
class Light(Object):
    kind: str = "point"
    intensity: Vec3 = (1.0, 1.0, 1.0)
    inner_cone_angle: float = 0.0
    outer_cone_angle: float = 0.785398163397


@dataclass(frozen=True)
class Camera(Object):
    vertical_fov: float = 0.7
    aspect_ratio: float = 0.0  # width / height; 0 = the picture's


@dataclass(frozen=True)
class Background(Object):
    color: Vec3 = (0.0, 0.0, 0.0)
    environment: int = 0
    strength: float = 1.0
    rotation: float = 0.0


@dataclass(frozen=True)
class Attachment(Object):
    key: str = ""
    value: str = ""
