"""Records that decode each field of a message when it is first read.

Most agents read only a few of the many fields. Decoding all of them takes 24 µs, and three times as long
where ten agents share two cores and their caches are cold: a fifth of the processor time of an agent's step.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self


class LazyRecord:
    """Base of frozen dataclasses with slots, constructed with all fields or with ``read_by``."""

    __slots__ = ("_read",)

    @classmethod
    def read_by(cls, read: Callable[[str], Any]) -> Self:
        """Return a record whose fields have not been decoded yet.

        Args:
            read: Returns the value of a field by its name; called once for each field that is read.
        """
        record = object.__new__(cls)
        object.__setattr__(record, "_read", read)
        return record

    if not TYPE_CHECKING:  # otherwise type checkers would accept a misspelt field

        def __getattr__(self, name: str) -> Any:
            """Decode a field. Python calls this for attributes that are not set."""
            if name not in self.__dataclass_fields__:
                kind = type(self).__name__
                raise AttributeError(f"{kind!r} object has no attribute {name!r}", name=name, obj=self)
            value = self._read(name)
            object.__setattr__(self, name, value)
            return value
