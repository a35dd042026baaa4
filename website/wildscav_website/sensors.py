"""The page of every sensor, from the registry: options with their ranges, and each number of a reading."""

from collections.abc import Iterator
from inspect import getdoc
from typing import Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le

from wildscav_engine.sensors import SENSORS
from wildscav_engine.sensors.base import Sensor
from wildscav_website.markdown import code, table
from wildscav_website.sdk import fields_of

HEAD = """# Every sensor

Each sensor with its options and the numbers of its readings, from the code. [Sensors](../sensors.md) says how
you request them, and shows what cameras see. Unused rows of lists are 0.
"""


def page() -> str:
    """Return the page."""
    return "\n".join([HEAD, *(part for name in SENSORS for part in _entry(name, SENSORS[name]))])


def _entry(name: str, kind: type[Sensor]) -> Iterator[str]:
    sensor = kind()
    yield f"## {name}\n\n{(getdoc(kind) or '').replace('``', '`')}\n"
    shape = f"the shape {code(sensor.space.shape)} and the type {sensor.space.dtype}"
    yield f"A reading of {code(kind.__name__)} has {shape}, by default.\n"
    meanings = meanings_of(kind)
    options = (
        (code(one), code(repr(getattr(sensor, one))), range_of(kind, one), meanings[one])
        for one in kind.__pydantic_fields__  # type: ignore[attr-defined]
    )
    yield table(("option", "default", "range", "what it is"), options)
    numbers = (
        (str(place), one.name, one.unit, f"{one.low:g}", f"{one.high:g}", one.meaning)
        for place, one in enumerate(sensor.columns)
    )
    yield table(("no.", "number", "unit", "min", "max", "what it is"), numbers)


def meanings_of(kind: type[Sensor]) -> dict[str, str]:
    """Return what the comment beside each option says, those of base classes included."""
    bases = [base for base in reversed(kind.__mro__) if issubclass(base, Sensor)]
    return {field.name: field.meaning for base in bases for field in fields_of(base)}


def range_of(kind: type[Sensor], option: str) -> str:
    """Say what an option may be."""
    field = kind.__pydantic_fields__[option]  # type: ignore[attr-defined]
    if field.annotation is bool:
        return "True, False"
    if get_origin(field.annotation) is Literal:
        return ", ".join(f'"{word}"' for word in get_args(field.annotation))
    (least,) = [limit for limit in field.metadata if isinstance(limit, Ge | Gt)]
    (most,) = [limit.le for limit in field.metadata if isinstance(limit, Le)]
    return f"{least.ge} to {most}" if isinstance(least, Ge) else f"above {least.gt}, to {most}"
