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
    set: int = 0  # which texture coordinates of a geometry: tex_coords or tex_coords_1


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
    motion: tuple[Matrix, ...] = ()  # at even steps of time after matrix, until the shutter closes; at most 15


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
    tex_coords_1: Blob = Blob()  # as tex_coords
    medium: int = 0
    motion_positions: tuple[Blob, ...] = ()  # at even steps of time after positions
    motion_normals: tuple[Blob, ...] = ()  # none, or as many


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
    transmission_texture: TextureSlot = TextureSlot()
    thickness: float = 0.0
    attenuation_color: Vec3 = (1.0, 1.0, 1.0)
    attenuation_distance: float = 0.0
    specular: float = 1.0
    specular_texture: TextureSlot = TextureSlot()
    specular_color: Vec3 = (1.0, 1.0, 1.0)
    specular_color_texture: TextureSlot = TextureSlot()
    clearcoat: float = 0.0
    clearcoat_texture: TextureSlot = TextureSlot()
    clearcoat_roughness: float = 0.0
    clearcoat_roughness_texture: TextureSlot = TextureSlot()
    clearcoat_normal_texture: TextureSlot = TextureSlot()
    clearcoat_normal_scale: float = 1.0
    sheen_color: Vec3 = (0.0, 0.0, 0.0)
    sheen_color_texture: TextureSlot = TextureSlot()
    sheen_roughness: float = 0.0
    sheen_roughness_texture: TextureSlot = TextureSlot()
    anisotropy: float = 0.0
    anisotropy_rotation: float = 0.0
    anisotropy_texture: TextureSlot = TextureSlot()
    iridescence: float = 0.0
    iridescence_texture: TextureSlot = TextureSlot()
    iridescence_index_of_refraction: float = 1.3
    iridescence_thickness_minimum: float = 100.0
    iridescence_thickness_maximum: float = 400.0
    iridescence_thickness_texture: TextureSlot = TextureSlot()
    shadow_catcher: bool = False


@dataclass(frozen=True)
class Texture(Object):
    width: int = 0
    height: int = 0
    format: str = "rgba8"
    wrap_s: str = "repeat"
    wrap_t: str = "repeat"
    filter: str = "linear"
    texels: Blob = Blob()  # rows from the top, slices one after the other
    depth: int = 1  # slices; only media read more than the first


@dataclass(frozen=True)
class Light(Object):
    kind: str = "point"
    intensity: Vec3 = (1.0, 1.0, 1.0)
    inner_cone_angle: float = 0.0
    outer_cone_angle: float = 0.785398163397
    radius: float = 0.1
    size: Vec2 = (1.0, 1.0)
    angle: float = 0.0


@dataclass(frozen=True)
class Camera(Object):
    vertical_fov: float = 0.7
    aspect_ratio: float = 0.0  # width / height; 0 = the picture's
    projection: str = "perspective"
    orthographic_height: float = 2.0
    lens_radius: float = 0.0  # 0 = a pinhole
    focus_distance: float = 1.0
    aperture: str = "uniform"


@dataclass(frozen=True)
class Background(Object):
    color: Vec3 = (0.0, 0.0, 0.0)
    environment: int = 0
    strength: float = 1.0
    rotation: float = 0.0
    visible: str = "environment"  # to camera rays that hit nothing; or "color"
    visible_color: Vec4 = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Attachment(Object):
    key: str = ""
    value: str = ""


@dataclass(frozen=True)
class SurfaceShader(Object):
    emission: Vec3 = (0.0, 0.0, 0.0)
    emission_texture: TextureSlot = TextureSlot()
    ambient: Vec3 = (0.2, 0.2, 0.2)
    ambient_texture: TextureSlot = TextureSlot()
    diffuse: Vec3 = (0.8, 0.8, 0.8)
    diffuse_texture: TextureSlot = TextureSlot()
    specular: Vec3 = (0.0, 0.0, 0.0)
    specular_texture: TextureSlot = TextureSlot()
    shininess: Vec2 = (0.0, 0.0)
    shininess_texture: TextureSlot = TextureSlot()
    alpha: float = 1.0
    alpha_texture: TextureSlot = TextureSlot()
    invert_alpha_texture: bool = False
    normal_texture: TextureSlot = TextureSlot()
    normal_format: str = "unorm"
    normal_space: str = "tangent"
    normal_scale: Vec3 = (2.0, 2.0, 2.0)
    normal_bias: Vec3 = (-1.0, -1.0, -1.0)
    height_texture: TextureSlot = TextureSlot()
    height_scale: float = 1.0
    reflection: Vec3 = (0.0, 0.0, 0.0)
    reflection_texture: TextureSlot = TextureSlot()
    transmission: Vec3 = (0.0, 0.0, 0.0)
    transmission_texture: TextureSlot = TextureSlot()
    relative_index_of_refraction: Vec3 = (1.0, 1.0, 1.0)
    fresnel_blend: float = 1.0
    tangent_tex_coords: int = -1
    binormal_tex_coords: int = -1
    environment: Vec3 = (0.0, 0.0, 0.0)
    environment_texture: TextureSlot = TextureSlot()


@dataclass(frozen=True)
class Medium(Object):
    emission: Vec3 = (0.0, 0.0, 0.0)
    emission_texture: TextureSlot = TextureSlot()
    absorption: Vec3 = (0.0, 0.0, 0.0)
    absorption_texture: TextureSlot = TextureSlot()
    scattering: Vec3 = (0.0, 0.0, 0.0)
    scattering_texture: TextureSlot = TextureSlot()
    anisotropy: float = 0.0
    priority: int = 0
