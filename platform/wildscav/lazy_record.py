"""Records whose fields are read out of a message only when they are first asked for.

Most agents look at a few fields of many. To read them all takes an agent 24 µs, and three times as long where
ten agents share two cores and find the caches cold: a fifth of the processor time that a step costs it.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self


class LazyRecord:
    """Base of frozen dataclasses with slots; made in full, or with ``read_by``."""

    __slots__ = ("_read",)

    @classmethod
    def read_by(cls, read: Callable[[str], Any]) -> Self:
        """Return a record that is not read yet.

        Args:
            read: Returns a field's value by its name; it is called once for each field that is asked for.
        """
        record = object.__new__(cls)
        object.__setattr__(record, "_read", read)
        return record

    if not TYPE_CHECKING:  # or a misspelt field would pass for one of any type

        def __getattr__(self, name: str) -> Any:
            """Read a field; Python calls this for what is not there (yet)."""
            if name not in self.__dataclass_fields__:
                kind = type(self).__name__
                raise AttributeError(f"{kind!r} object has no attribute {name!r}", name=name, obj=self)
            value = self._read(name)
            object.__setattr__(self, name, value)
            return value
