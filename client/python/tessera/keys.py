"""CURVE keys as stored by the programs: a folder of `tessera keys DIR`, or one exported file."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

from .errors import InvalidInput, Refused

_LIMIT = 1 << 20
_Z85 = re.compile(r"[0-9a-zA-Z.\-:+=^!/*?&<>()\[\]{}@%$#]{40}")
_NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")


@dataclass(frozen=True)
class ClientKeys:
    """A client's key pair and the master's public key; Z85 text."""

    public: str
    secret: str
    master: str

    def __repr__(self) -> str:  # keeps the secret out of tracebacks
        return f"ClientKeys(public={self.public!r})"


def load(path: str | os.PathLike[str], user: str) -> ClientKeys:
    """The key pair of `user` in a folder, or the pair of an exported file. Raises InvalidInput for missing or damaged
    files, Refused for a secret key that other users may read."""
    place = Path(path).expanduser()
    if place.is_file():
        _require_private(place)
        return _exported(place, _text(place))
    if not _NAME.fullmatch(user):
        raise InvalidInput(f"'{user}' is not the name of a key: see 'tessera keys DIR list'")
    secret = place / f"{user}.secret"
    _require_private(secret)
    return ClientKeys(_key(place / f"{user}.public"), _key(secret), _key(place / "master.public"))


def _require_private(path: Path) -> None:
    try:
        mode = path.stat().st_mode
    except OSError:
        raise InvalidInput(f"no secret key '{path}': make keys with 'tessera keys DIR'") from None
    if mode & 0o077:
        raise Refused(f"the secret key '{path}' is open to others: chmod 600 '{path}'")


def _text(path: Path) -> str:
    try:
        with open(path, "rb") as file:
            data = file.read(_LIMIT + 1)
    except OSError as error:
        raise InvalidInput(
            f"cannot read '{path}': {error.strerror}; make keys with 'tessera keys DIR'") from None
    if len(data) > _LIMIT:
        raise InvalidInput(f"'{path}' is too large to hold keys")
    return data.decode("utf-8", "replace")


def _checked(path: Path, text: str) -> str:
    if not _Z85.fullmatch(text):
        raise InvalidInput(f"'{path}' contains no key: create new ones with 'tessera keys DIR'")
    return text


def _key(path: Path) -> str:
    return _checked(path, _text(path).strip())


def _exported(path: Path, text: str) -> ClientKeys:
    values: dict[str, str] = {}
    for line in map(str.strip, text.splitlines()):
        if not line or line.startswith("#"):
            continue
        found = re.fullmatch(r'(\w+)\s*=\s*"([^"]*)"', line)
        if found is None:
            raise InvalidInput(f"'{path}' is no exported key file: make one with "
                               "'tessera keys DIR add NAME --export FILE'")
        values[found[1]] = found[2]
    for needed in ("public", "secret", "master"):
        if needed not in values:
            raise InvalidInput(f"'{path}' is no exported key file (without '{needed}'): make one with "
                               "'tessera keys DIR add NAME --export FILE'")
    return ClientKeys(*(_checked(path, values[name]) for name in ("public", "secret", "master")))
