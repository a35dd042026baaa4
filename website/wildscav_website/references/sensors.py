"""The page of every sensor, from the registry: options with their ranges, and each number of a reading."""

import json
from collections.abc import Iterator
from inspect import getdoc
from typing import Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le

from wildscav_engine.sensors import SENSORS
from wildscav_engine.sensors.base import Sensor
from wildscav_website.markdown import code, number, prose, table
from wildscav_website.references.sdk import meanings_of

HEAD = """# Every sensor

Each sensor with its options and the numbers of its readings, from the code. [Sensors](../sensors.md) says how
you request them, and shows what cameras see. Unused rows of lists are 0.
"""


def page() -> str:
    """Return the page."""
    return "\n".join([HEAD, *(part for name in SENSORS for part in _entry(name, SENSORS[name]))])


def _entry(name: str, kind: type[Sensor]) -> Iterator[str]:
    sensor = kind()
    yield f"## {name}\n\n{prose(getdoc(kind) or '')}\n"
    shape, size = shape_of(sensor), sensor.space.shape
    by_default = "" if shape == str(size) else f", by default {code(size)}"
    reading = f"the type {sensor.space.dtype} and the shape {code(shape)}{by_default}"
    yield f"A reading of {code(kind.__name__)} has {reading}.\n"
    meanings = meanings_of(kind)
    options = (
        (code(one), code(json.dumps(getattr(sensor, one))), range_of(kind, one), meanings[one])
        for one in kind.__pydantic_fields__  # type: ignore[attr-defined]
    )
    yield table(("option", "default", "range", "what it is"), options)
    numbers = (
        (str(place), one.name, one.unit, number(one.low), number(one.high), one.meaning)
        for place, one in enumerate(sensor.columns)
    )
    yield table(("no.", "number", "unit", "min", "max", "what it is"), numbers)


def shape_of(sensor: Sensor) -> str:
    """Return the shape of readings, with the names of the options that set it."""
    sizes = [str(size) for size in sensor.space.shape]
    for option in type(sensor).__pydantic_fields__:  # type: ignore[attr-defined]
        if type(value := getattr(sensor, option)) is int:
            other = type(sensor)(**{option: value - 1}).space.shape
            sizes = [option if other[at] != sensor.space.shape[at] else size for at, size in enumerate(sizes)]
    return f"({', '.join(sizes)}{',' * (len(sizes) == 1)})"


def range_of(kind: type[Sensor], option: str) -> str:
    """Say what an option may be."""
    field = kind.__pydantic_fields__[option]  # type: ignore[attr-defined]
    if field.annotation is bool:
        return "true, false"
    if get_origin(field.annotation) is Literal:
        return ", ".join(f'"{word}"' for word in get_args(field.annotation))
    (least,) = [limit for limit in field.metadata if isinstance(limit, Ge | Gt)]
    (most,) = [limit.le for limit in field.metadata if isinstance(limit, Le)]
    return f"{least.ge} to {most}" if isinstance(least, Ge) else f"above {least.gt}, to {most}"
