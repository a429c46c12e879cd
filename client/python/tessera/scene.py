"""The live scene, as mirrored by a member."""

from __future__ import annotations

from typing import TYPE_CHECKING, Iterator, TypeVar

from .errors import InvalidInput
from .fields import KIND_OF_TYPE, object_id
from .mirror import Version
from .objects import Root
from .values import Blob, Object, ROOT_ID

if TYPE_CHECKING:
    from .session import Session

T = TypeVar("T", bound=Object)


class Scene:
    """A mirror of the master's scene. Reads include at least all commits of this session; `refresh` fetches the edits of
    others. Objects are immutable values."""

    def __init__(self, session: Session) -> None:
        self._session = session

    @property
    def title(self) -> str:
        return self._session.title

    @property
    def version(self) -> Version:
        """Epoch and number of the mirrored version."""
        with self._session.reading() as mirror:
            return mirror.version

    @property
    def root(self) -> Root:
        with self._session.reading() as mirror:
            value = mirror.value(ROOT_ID)
        assert isinstance(value, Root)
        return value

    def refresh(self) -> Version:
        """Fetches changes from the master."""
        return self._session.refresh().version

    def __getitem__(self, which: str | int) -> Object:
        """By path ("materials/red", "lights/lamp@65540", "root") or id. Raises InvalidInput with the nearest path."""
        with self._session.reading() as mirror:
            return mirror.value(mirror.find(which) if isinstance(which, str) else which)

    def get(self, kind: type[T], name: str) -> T:
        """The same with a type: scene.get(tessera.Material, "red")."""
        with self._session.reading() as mirror:
            value = mirror.value(mirror.find(f"{KIND_OF_TYPE[kind].plural}/{name}"))
        assert isinstance(value, kind)
        return value

    def all(self, kind: type[T]) -> list[T]:
        """Every object of a kind, by id."""
        with self._session.reading() as mirror:
            values = [mirror.value(number) for number in mirror.of_kind(KIND_OF_TYPE[kind])]
        return [value for value in values if isinstance(value, kind)]

    def path(self, of: Object | int) -> str:
        """The shortest unambiguous path of the object."""
        with self._session.reading() as mirror:
            return mirror.path(object_id(of))

    def __contains__(self, which: object) -> bool:
        with self._session.reading() as mirror:
            try:
                return (mirror.find(which) if isinstance(which, str) else object_id(which)) in mirror
            except InvalidInput:
                return False

    def __len__(self) -> int:
        with self._session.reading() as mirror:
            return len(mirror)

    def __iter__(self) -> Iterator[Object]:
        with self._session.reading() as mirror:
            return iter([mirror.value(number) for number in mirror.ids()])

    def bytes_of(self, blob: Blob) -> bytes:
        """The contents of a blob of the scene: floats(scene.bytes_of(geometry.positions))."""
        return self._session.fetch(blob)
