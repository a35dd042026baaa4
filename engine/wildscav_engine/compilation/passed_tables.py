"""Tables of arrays: their columns, and which classes kernels pass to each other as tables.

For what they are, see ``array_tables.py`` and ``table_type.py``.
"""

from typing import TypeVar

Class = TypeVar("Class")

ADDRESS, ITEM, ROWS, LENGTH = 0, 1, 2, 3  # columns: of the first byte; bytes per item; the first two axes
AXES = 4  # the largest number of axes of an array
COLUMNS = 2 + AXES

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
