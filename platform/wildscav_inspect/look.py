"""``wildscav map look``: a picture of what a sensor sees at a place on a map."""

import math
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from wildscav.cli.shared_options import takes
from wildscav.errors import UserError
from wildscav_inspect.map_options import MapCommand, MapOptions, format_of, save

if TYPE_CHECKING:
    from PIL.Image import Image

    from wildscav_engine.geometry.world import World
    from wildscav_engine.maps import GameMap
    from wildscav_engine.maps.viewpoints import Viewpoint
    from wildscav_engine.sensors.optics.image_sensor import ImageSensor

WIDTH, ASPECT = 960, 9 / 16  # default width in pixels; height divided by width
Place = tuple[float, float, float]


class Coordinates(NamedTuple):
    """The coordinates in an option of the command line."""

    option: str
    form: str  # such as "X,Z"
    numbers: tuple[float, ...]


app = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode="rich")


@app.command(cls=MapCommand)
@takes(MapOptions)
def look(
    named: MapOptions,
    sensor: Annotated[
        str, typer.Option(help="The sensor to use: any that makes images, such as depth.")
    ] = "camera",
    position: Annotated[
        str | None,
        typer.Option(
            metavar="X,Z|X,Y,Z",
            help="Position of the eyes, in metres. Without Y: at eye height of an agent that stands there, "
            "on the ground, on a ground floor or at the surface of a lake. Default: a place outdoors "
            "with a view of a house.",
        ),
    ] = None,
    yaw: Annotated[float | None, typer.Option(help="Degrees: 0 north (+z), 90 east.")] = None,
    pitch: Annotated[float | None, typer.Option(help="Degrees, -90 to 90: positive looks down.")] = None,
    option: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=VALUE", help="An option of the sensor, as in submission.toml."),
    ] = None,
    width: Annotated[int | None, typer.Option(help=f"Pixels. Default: {WIDTH}.")] = None,
    height: Annotated[int | None, typer.Option(help="Pixels. Default: 9/16 of the width.")] = None,
    far: Annotated[float | None, typer.Option(help="Range of the sensor in metres.")] = None,
    field_of_view: Annotated[float | None, typer.Option(help="Degrees from left to right.")] = None,
    agent: Annotated[
        list[str] | None,
        typer.Option(metavar="X,Z,YAW|X,Y,Z,YAW", help="Place an agent there. May be repeated."),
    ] = None,
    box: Annotated[
        list[str] | None,
        typer.Option(metavar="X,Z|X,Y,Z", help="Place a supply box there. May be repeated."),
    ] = None,
    legend: Annotated[bool, typer.Option(help="Add a legend of the colours below the picture.")] = True,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="File to write. Default: map-NAME-SENSOR.png.")
    ] = None,
) -> None:
    """Draw what a sensor sees at a place on a map."""
    if out is not None:
        format_of(out)
    agents = [_read("agent", text, "X,Z,YAW") for text in agent or ()]
    boxes = [_read("box", text, "X,Z") for text in box or ()]
    size = {"width": width, "height": height, "far": far, "field_of_view": field_of_view}
    optical_sensor = _sensor(sensor, size, option or [], bool(agents or boxes))
    place = None if position is None else _read("position", position, "X,Z")
    _check_angles(yaw, pitch)
    choice = named.choose()
    view = _viewpoint(choice.game_map, place, yaw, pitch)
    picture = _picture(optical_sensor, choice.game_map, view, agents, boxes, legend=legend)
    path = out or Path(f"{choice.slug}-{sensor}.png")
    _print_saved(save(picture, path), view)


def _picture(
    sensor: "ImageSensor",
    game_map: "GameMap",
    view: "Viewpoint",
    agents: Sequence[Coordinates],
    boxes: Sequence[Coordinates],
    *,
    legend: bool,
) -> "Image":
    """Return what a sensor sees on a map with the given agents and boxes."""
    from wildscav.terminal.console import error_console
    from wildscav_engine.sensors.display.legend import draw_reading
    from wildscav_engine.sensors.optics.dynamic_objects import placed_objects

    placed = placed_objects(
        [(_place(game_map, agent), agent.numbers[-1]) for agent in agents],
        [_place(game_map, box) for box in boxes],
    )
    moving = placed if getattr(sensor, "moving", True) else None
    with error_console.status("drawing"):
        reading = sensor.render(game_map, [view.eye], [view.yaw], [view.pitch], moving=moving)[0]
        return draw_reading(sensor, reading, legend=legend)


def _print_saved(saved: str, view: "Viewpoint") -> None:
    """Print what was written, and the options that repeat the view."""
    from wildscav.terminal.console import console

    x, y, z = view.eye
    console.print(
        f"{saved}, seen with "
        f"--position {x:.2f},{y:.2f},{z:.2f} --yaw {view.yaw:.1f} --pitch {view.pitch:.1f}",
        markup=False,
    )


def _sensor(name: str, size: dict[str, Any], options: Sequence[str], has_objects: bool) -> "ImageSensor":
    """Return the sensor with its options, each KEY=VALUE, and with a default size that suits a picture."""
    from wildscav_engine.sensors import SENSORS, parse_sensor
    from wildscav_engine.sensors.optics.image_sensor import ImageSensor

    images = [each for each, kind in SENSORS.items() if issubclass(kind, ImageSensor)]
    if name not in images:
        why = "makes no image" if name in SENSORS else "does not exist"
        raise UserError(f"sensor {name!r} {why}; sensors that do are {', '.join(images)}", exit_code=2)
    given = {key: value for key, value in size.items() if value is not None}
    for text in options:
        key, value = _read_option(text)
        if key in given:
            raise UserError(f"the sensor's option {key!r} is given twice", exit_code=2)
        given[key] = value
    try:
        sensor = parse_sensor(name, given)
        sensor = parse_sensor(name, _defaults(sensor, given, has_objects) | given)
    except ValueError as error:
        raise UserError(str(error), exit_code=2) from None
    if not isinstance(sensor, ImageSensor):
        raise TypeError(f"{name} makes no image")
    return sensor


def _defaults(sensor: object, given: dict[str, Any], has_objects: bool) -> dict[str, Any]:
    """Return defaults of options: a size that suits a picture, and that placed objects are seen."""
    from wildscav_engine.sensors.optics.pinhole import PinholeCamera

    defaults: dict[str, Any] = {}
    if isinstance(sensor, PinholeCamera):
        wide = sensor.width if "width" in given else WIDTH
        defaults = {"width": wide, "height": max(1, round(wide * ASPECT))}
    if has_objects and hasattr(sensor, "moving"):
        defaults["moving"] = True
    return defaults


def _read_option(text: str) -> tuple[str, Any]:
    """Return the key and the value of KEY=VALUE; a value that is not valid TOML is a string."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if not key or not equals:
        raise UserError(f"option is {text!r}, must be KEY=VALUE, such as far=50", exit_code=2)
    try:
        return key, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key, value


def _read(option: str, text: str, form: str) -> Coordinates:
    """Return the numbers of an option in a form such as "X,Z", or in the same form with a Y."""
    full = form.replace("X,", "X,Y,")
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    lengths = (form.count(",") + 1, full.count(",") + 1)
    if len(numbers) not in lengths or not all(math.isfinite(number) for number in numbers):
        raise UserError(f"{option} is {text!r}, must be {form} or {full}, numbers in metres", exit_code=2)
    return Coordinates(option, form, numbers)


def _check_angles(yaw: float | None, pitch: float | None) -> None:
    if yaw is not None and not -360 <= yaw <= 360:
        raise UserError(f"yaw is {yaw:g}, must be -360 to 360 degrees", exit_code=2)
    if pitch is not None and not -90 <= pitch <= 90:
        raise UserError(f"pitch is {pitch:g}, must be -90 to 90 degrees", exit_code=2)


def _place(game_map: "GameMap", coordinates: Coordinates) -> Place:
    """Return a place on the map; without a height in the coordinates, the height where an agent stands."""
    from wildscav_engine.maps.viewpoints import standing_height

    numbers = coordinates.numbers
    has_height = len(numbers) > coordinates.form.count(",") + 1
    x, z = numbers[0], numbers[2 if has_height else 1]
    half = game_map.config.size / 2
    if not (abs(x) < half and abs(z) < half):
        raise UserError(
            f"{coordinates.option} is {x:g},{z:g}, must be within {-half:g} to {half:g} m", exit_code=2
        )
    return x, numbers[1] if has_height else standing_height(game_map.world, x, z), z


def _viewpoint(
    game_map: "GameMap", position: Coordinates | None, yaw: float | None, pitch: float | None
) -> "Viewpoint":
    """Return the given viewpoint, or by default one with a view of a house."""
    from wildscav_engine.maps.viewpoints import Viewpoint, viewpoint_of
    from wildscav_engine.specs.body import EYE_HEIGHT

    if position is None:
        view = viewpoint_of(game_map)
    else:
        x, y, z = _place(game_map, position)
        eye = (x, y if len(position.numbers) > 2 else y + EYE_HEIGHT, z)
        _check_free(game_map.world, eye)
        view = Viewpoint(eye, 0.0, 0.0)
    return view._replace(yaw=view.yaw if yaw is None else yaw, pitch=view.pitch if pitch is None else pitch)


def _check_free(world: "World", eye: Place) -> None:
    """Refuse a place below the ground or inside an object."""
    from wildscav_engine.geometry.rays import TERRAIN_HIT, raycast
    from wildscav_engine.geometry.world import Kind

    x, y, z = eye
    hit = raycast(world, x, y, z, 0.0, 1.0, 0.0, 1.0)
    if hit.distance > 0.0:
        return
    inside = (
        "the ground" if hit.solid == TERRAIN_HIT else f"a {Kind(world.solid_kind[hit.solid]).name.lower()}"
    )
    raise UserError(f"position is {x:g},{y:.2f},{z:g}: nothing can be seen inside {inside}", exit_code=2)
