"""Tessera from Python: join a live scene, edit it in transactions, render views of it.

    with tessera.connect("tcp://127.0.0.1:7420", keys="~/.tessera") as session:
        scene = session.join("room")
        with session.transaction() as edit:
            edit.set(scene["materials/red"], base_color=(0.8, 0.1, 0.1, 1.0))

Objects are values (`objects.py`); paths, fields and units are those of the command `tessera edit`.
"""

from __future__ import annotations

import os
import secrets
from typing import Any

from . import endpoint as _endpoint
from . import keys as _keys
from . import old_names as _old_names
from .camera import Pose, look_at, multiply, translation
from .connection import Connection as _Connection
from .errors import Error, InvalidInput, Malformed, Refused, Unavailable
from .film import Film, floats
from .frame import Frame
from .link import LinkSettings as _LinkSettings
from .objects import (Attachment, Background, Camera, Geometry, Light, Material, Medium, Root, SurfaceShader, Texture,
                      TextureSlot, Transform)
from .records import Committed, FailedTile, Hit, Member, Members, Progress, Status, Summary, Writer
from .scene import Scene
from .session import Session
from .transaction import Transaction
from .values import ROOT_ID, Blob, Object
from .view import Rendered, View

__all__ = [
    "connect", "look_at", "multiply", "translation", "floats", "Session", "Scene", "Transaction", "View", "Frame",
    "Film", "Pose", "Object", "Root", "Transform", "Geometry", "Material", "Texture", "TextureSlot", "Light", "Camera",
    "Background", "Attachment", "SurfaceShader", "Medium", "Blob", "ROOT_ID", "Committed", "FailedTile", "Hit", "Member", "Members", "Progress", "Rendered",
    "Status", "Summary", "Writer", "Error", "InvalidInput", "Malformed", "Refused", "Unavailable",
]


def __getattr__(name: str) -> Any:
    present = _old_names.MODULE_NAMES.get(name)
    if present is None:
        raise AttributeError(f"module 'tessera' has no attribute '{name}'")
    _old_names.warn(name, present)
    return globals()[present]


def connect(where: str = "tcp://127.0.0.1:7420", *, keys: str | os.PathLike[str] | None = None, user: str = "editor",
            name: str = "python", key: int | None = None, connect_limit: float = 10.0,
            lost_limit: float = 30.0) -> Session:
    """Connects to the master at `where`. `keys`: the folder of `tessera keys`, from which the key pair of `user` is used, or an
    exported key file; None = not encrypted, loopback addresses only. `name`: shown to other members. `key`: the number of an
    earlier session of this user, to resume it; None = a new session. Raises Unavailable if the master does not answer within
    `connect_limit` seconds; later calls raise it after `lost_limit` seconds without a message."""
    place = _endpoint.parse(where)
    _endpoint.require_keys(place, keys is not None)
    pair = None if keys is None else _keys.load(keys, user)
    settings = _LinkSettings(name, "tessera-python", connect_limit, lost_limit)
    return Session(_Connection(place, pair, settings, secrets.randbits(64) | 1 if key is None else key))
