"""Camera poses of views."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Sequence

from .errors import InvalidInput
from .objects import KIND_ROWS, Camera
from .values import Matrix, Vec3

_CHOICES = {row.name: row.choices for kind in KIND_ROWS if kind.type is Camera for row in kind.fields}
PROJECTIONS, APERTURES = _CHOICES["projection"], _CHOICES["aperture"]  # in the order of the wire
MAX_MOTION = 15  # motion keys after the first


@dataclass(frozen=True)
class Pose:
    """A camera in the world: it looks along -z, y is up. Angles in radians, lengths in metres. The fields are those of the
    scene's Camera: without a lens radius it is a pinhole; an orthographic one sees as much as its height says, whatever
    its field of view. Raises InvalidInput for invalid values."""

    world_from_camera: Matrix
    vertical_fov: float = 0.7
    projection: str = "perspective"  # or "orthographic"
    orthographic_height: float = 2.0
    lens_radius: float = 0.0  # 0 = a pinhole
    focus_distance: float = 1.0  # of the focal plane, along the axis
    aperture: str = "uniform"  # or "gaussian"
    motion: tuple[Matrix, ...] = ()  # world_from_camera at uniform motion keys, the last when the shutter closes

    def __post_init__(self) -> None:
        if not 0.0 < self.vertical_fov < math.pi:
            raise InvalidInput("the field of view is not between 0 and pi")
        for value, known in ((self.projection, PROJECTIONS), (self.aperture, APERTURES)):
            if value not in known:
                raise InvalidInput(f"there is no '{value}': choose of {', '.join(known)}")
        if not (0.0 < self.orthographic_height < math.inf and 0.0 < self.focus_distance < math.inf):
            raise InvalidInput("the orthographic height or the focus distance is not positive")
        if not 0.0 <= self.lens_radius < math.inf:
            raise InvalidInput("the lens radius is negative: 0 is a pinhole")
        if len(self.motion) > MAX_MOTION:
            raise InvalidInput(f"the motion has {len(self.motion)} keys: at most {MAX_MOTION} after the first are allowed")
        for matrix in (self.world_from_camera, *self.motion):
            if len(matrix) != 16 or not all(math.isfinite(v) for v in matrix):
                raise InvalidInput("a matrix of the camera is not 16 finite numbers")

    def moving_to(self, *poses: Pose) -> Pose:
        """The same camera moving through these poses, at uniform motion keys while the shutter is open, with linear
        interpolation. Only their positions and directions are used."""
        return replace(self, motion=tuple(pose.world_from_camera for pose in poses))

    def frustum(self, width: int, height: int) -> tuple[float, float, float, float]:
        """Left, right, bottom, top of a picture of so many pixels: at distance 1, orthographic in metres."""
        if self.projection == "perspective":
            return frustum(self.vertical_fov, width, height)
        top = 0.5 * self.orthographic_height
        right = top * width / height
        return -right, right, -top, top


def look_at(eye: Sequence[float], target: Sequence[float], up: Sequence[float] = (0.0, 1.0, 0.0),
            vertical_fov: float = 0.7, *, projection: str = "perspective", orthographic_height: float = 2.0,
            lens_radius: float = 0.0, focus_distance: float = 1.0, aperture: str = "uniform") -> Pose:
    """From `eye` towards `target`. Raises InvalidInput if the direction is zero, and as Pose does."""
    at = _vector(eye)
    back = _normalized(_difference(at, _vector(target)), "eye and target are the same point")
    right = _normalized(_cross(_vector(up), back), "the view goes along 'up': give another one")
    return Pose(_matrix(right, _cross(back, right), back, at), vertical_fov, projection, orthographic_height,
                lens_radius, focus_distance, aperture)


def rigid(matrix: Matrix) -> Matrix:
    """The same position and direction without scale or shear. Raises InvalidInput if axes coincide."""
    back = _normalized((matrix[8], matrix[9], matrix[10]), "the camera's transform is flat")
    up = (matrix[4], matrix[5], matrix[6])
    right = _normalized(_cross(up, back), "the camera's transform is flat")
    return _matrix(right, _cross(back, right), back, (matrix[12], matrix[13], matrix[14]))


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """a b, column by column."""
    return tuple(sum(a[4 * k + row] * b[4 * column + k] for k in range(4))
                 for column in range(4) for row in range(4))


def translation(x: float, y: float, z: float) -> Matrix:
    """A transform's matrix."""
    return _matrix((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (x, y, z))


def frustum(vertical_fov: float, width: int, height: int) -> tuple[float, float, float, float]:
    """Left, right, bottom, top at distance 1."""
    top = math.tan(0.5 * vertical_fov)
    right = top * width / height
    return -right, right, -top, top


def _matrix(x: Vec3, y: Vec3, z: Vec3, at: Vec3) -> Matrix:
    return (*x, 0.0, *y, 0.0, *z, 0.0, *at, 1.0)


def _vector(value: Sequence[float]) -> Vec3:
    if len(value) != 3 or not all(math.isfinite(v) for v in value):
        raise InvalidInput("expected 3 finite numbers")
    return float(value[0]), float(value[1]), float(value[2])


def _difference(a: Vec3, b: Vec3) -> Vec3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Vec3, b: Vec3) -> Vec3:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _normalized(a: Vec3, otherwise: str) -> Vec3:
    length = math.hypot(*a)
    if length < 1e-12:
        raise InvalidInput(otherwise)
    return a[0] / length, a[1] / length, a[2] / length
