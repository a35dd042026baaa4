"""The classes of arrays that kernels pass to each other as tables; see ``table_type.py``."""

from typing import TypeVar

Class = TypeVar("Class")

_passed: set[type] = set()


def pass_as_table(kind: type[Class]) -> type[Class]:
    """Let kernels pass a NamedTuple class of arrays as one table; a decorator.

    Kernels may read its fields by their names, and nothing else: they cannot make, unpack or return one.
    """
    _passed.add(kind)
    return kind


def is_passed_as_table(kind: type) -> bool:
    """Return whether kernels pass a class as a table."""
    return kind in _passed
