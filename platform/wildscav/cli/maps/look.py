"""``wildscav look``: what a sensor sees from anywhere on a map."""

import math
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from wildscav.cli.maps.map_options import Choice, MapCommand, takes_a_map
from wildscav.cli.maps.picture_files import format_of, save
from wildscav.errors import UserError

if TYPE_CHECKING:
    from PIL.Image import Image

    from wildscav_engine.geometry.world import World
    from wildscav_engine.maps import GameMap
    from wildscav_engine.maps.viewpoints import Viewpoint
    from wildscav_engine.sensors.optics.optical import OpticalSensor

WIDTH, ASPECT = 960, 9 / 16  # pixels, where none are said; height over width
Place = tuple[float, float, float]


class Wanted(NamedTuple):
    """Numbers of an option, as they stand on the command line."""

    option: str
    form: str  # such as "X,Z"
    numbers: tuple[float, ...]


app = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode="rich")


@app.command(cls=MapCommand)
@takes_a_map
def look(
    choose: Callable[[], Choice],
    sensor: Annotated[
        str, typer.Option(help="Which sensor looks: any that makes images, such as depth.")
    ] = "camera",
    position: Annotated[
        str | None,
        typer.Option(
            metavar="X,Z|X,Y,Z",
            help="Where the eyes are, in metres. Without Y: as high as those of somebody who stands there, "
            "on the ground, a ground floor or at the surface of a lake. Without all: at a place outdoors "
            "that shows a house.",
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
    far: Annotated[float | None, typer.Option(help="Metres that a camera sees.")] = None,
    field_of_view: Annotated[float | None, typer.Option(help="Degrees from left to right.")] = None,
    agent: Annotated[
        list[str] | None,
        typer.Option(metavar="X,Z,YAW|X,Y,Z,YAW", help="Put an agent there. May be given often."),
    ] = None,
    box: Annotated[
        list[str] | None,
        typer.Option(metavar="X,Z|X,Y,Z", help="Put a supply box there. May be given often."),
    ] = None,
    legend: Annotated[bool, typer.Option(help="Say beneath what the colours mean.")] = True,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="File to write. Default: map-NAME-SENSOR.png.")
    ] = None,
) -> None:
    """Look at a map with a sensor: a picture of what it sees."""
    if output is not None:
        format_of(output)
    agents = [_read("agent", text, "X,Z,YAW") for text in agent or ()]
    boxes = [_read("box", text, "X,Z") for text in box or ()]
    size = {"width": width, "height": height, "far": far, "field_of_view": field_of_view}
    looking = _sensor(sensor, size, option or [], bool(agents or boxes))
    place = None if position is None else _read("position", position, "X,Z")
    _check_angles(yaw, pitch)
    choice = choose()
    view = _viewpoint(choice.game_map, place, yaw, pitch)
    picture = _picture(looking, choice.game_map, view, agents, boxes, legend=legend)
    path = output or Path(f"{choice.slug}-{sensor}.png")
    _say(save(picture, path), view)


def _picture(
    looking: "OpticalSensor",
    game_map: "GameMap",
    view: "Viewpoint",
    agents: Sequence[Wanted],
    boxes: Sequence[Wanted],
    *,
    legend: bool,
) -> "Image":
    """Return what a sensor sees of a map on which agents and boxes have been put.

    Raises:
        UserError: One of them is to be outside the map.
    """
    from wildscav.terminal.console import error_console
    from wildscav_engine.sensors.display.legend import draw_reading
    from wildscav_engine.sensors.optics.placed_objects import placed_objects

    things = placed_objects(
        [(_place(game_map, wanted), wanted.numbers[-1]) for wanted in agents],
        [_place(game_map, wanted) for wanted in boxes],
    )
    moving = things if getattr(looking, "moving", True) else None
    with error_console.status("looking"):
        reading = looking.render(game_map, [view.eye], [view.yaw], [view.pitch], moving=moving)[0]
        return draw_reading(looking, reading, legend=legend)


def _say(saved: str, view: "Viewpoint") -> None:
    """Say what was written, and how to look from there again."""
    from wildscav.terminal.console import console

    x, y, z = view.eye
    console.print(
        f"{saved}, seen with "
        f"--position {x:.2f},{y:.2f},{z:.2f} --yaw {view.yaw:.1f} --pitch {view.pitch:.1f}",
        markup=False,
        highlight=False,
        soft_wrap=True,
    )


def _sensor(name: str, size: dict[str, Any], options: Sequence[str], things: bool) -> "OpticalSensor":
    """Return the sensor with its options, of a size to look at where none is said.

    Args:
        name: In the registry.
        size: What options of the command's own say, None where they say nothing.
        options: KEY=VALUE each.
        things: Whether agents or boxes are there to be seen.

    Raises:
        UserError: There is no such sensor that makes an image, or it has no such option or value.
    """
    from wildscav_engine.sensors import SENSORS, parse_sensor
    from wildscav_engine.sensors.optics.optical import OpticalSensor

    images = [each for each, kind in SENSORS.items() if issubclass(kind, OpticalSensor)]
    if name not in images:
        why = "makes no image" if name in SENSORS else "does not exist"
        raise UserError(f"sensor {name!r} {why}; those to look with are {', '.join(images)}", exit_code=2)
    given = {key: value for key, value in size.items() if value is not None}
    for text in options:
        key, value = _read_option(text)
        if key in given:
            raise UserError(f"the sensor's option {key!r} is given twice", exit_code=2)
        given[key] = value
    try:
        sensor = parse_sensor(name, given)
        sensor = parse_sensor(name, _defaults(sensor, given, things) | given)
    except ValueError as error:
        raise UserError(str(error), exit_code=2) from None
    if not isinstance(sensor, OpticalSensor):
        raise TypeError(f"{name} makes no image")
    return sensor


def _defaults(sensor: object, given: dict[str, Any], things: bool) -> dict[str, Any]:
    """Return options for what is not given: a size for people's eyes, and to see what was put there."""
    from wildscav_engine.sensors.optics.pinhole import PinholeCamera

    defaults: dict[str, Any] = {}
    if isinstance(sensor, PinholeCamera):
        wide = sensor.width if "width" in given else WIDTH
        defaults = {"width": wide, "height": max(1, round(wide * ASPECT))}
    if things and hasattr(sensor, "moving"):
        defaults["moving"] = True
    return defaults


def _read_option(text: str) -> tuple[str, Any]:
    """Return the key and the value of KEY=VALUE; a value that TOML cannot read is a word."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if not key or not equals:
        raise UserError(f"option is {text!r}, must be KEY=VALUE, such as far=50", exit_code=2)
    try:
        return key, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key, value


def _read(option: str, text: str, form: str) -> Wanted:
    """Return the numbers of an option that has the form, or that with a Y in it.

    Raises:
        UserError: It has not.
    """
    full = form.replace("X,", "X,Y,")
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    lengths = (form.count(",") + 1, full.count(",") + 1)
    if len(numbers) not in lengths or not all(math.isfinite(number) for number in numbers):
        raise UserError(f"{option} is {text!r}, must be {form} or {full}, numbers in metres", exit_code=2)
    return Wanted(option, form, numbers)


def _check_angles(yaw: float | None, pitch: float | None) -> None:
    if yaw is not None and not -360 <= yaw <= 360:
        raise UserError(f"yaw is {yaw:g}, must be -360 to 360 degrees", exit_code=2)
    if pitch is not None and not -90 <= pitch <= 90:
        raise UserError(f"pitch is {pitch:g}, must be -90 to 90 degrees", exit_code=2)


def _place(game_map: "GameMap", wanted: Wanted) -> Place:
    """Return a place on the map; where one stands, if its height is not said.

    Raises:
        UserError: It is outside the map.
    """
    from wildscav_engine.maps.viewpoints import standing_height

    names_height = len(wanted.numbers) > wanted.form.count(",") + 1
    x, z = wanted.numbers[0], wanted.numbers[2 if names_height else 1]
    half = game_map.config.size / 2
    if not (abs(x) < half and abs(z) < half):
        raise UserError(
            f"{wanted.option} is {x:g},{z:g}, must be within {-half:g} to {half:g} m", exit_code=2
        )
    return x, wanted.numbers[1] if names_height else standing_height(game_map.world, x, z), z


def _viewpoint(
    game_map: "GameMap", wanted: Wanted | None, yaw: float | None, pitch: float | None
) -> "Viewpoint":
    """Return where to look from: what is said, and else a place that shows a house.

    Raises:
        UserError: Nothing can be seen from there.
    """
    from wildscav_engine.maps.viewpoints import Viewpoint, viewpoint_of
    from wildscav_engine.specs.body import EYE_HEIGHT

    if wanted is None:
        view = viewpoint_of(game_map)
    else:
        x, y, z = _place(game_map, wanted)
        eye = (x, y if len(wanted.numbers) > 2 else y + EYE_HEIGHT, z)
        _check_free(game_map.world, eye)
        view = Viewpoint(eye, 0.0, 0.0)
    return view._replace(yaw=view.yaw if yaw is None else yaw, pitch=view.pitch if pitch is None else pitch)


def _check_free(world: "World", eye: Place) -> None:
    """Refuse a place in the ground or inside of something.

    Raises:
        UserError: It is one.
    """
    from wildscav_engine.geometry.rays import TERRAIN_HIT, cast_ray
    from wildscav_engine.geometry.world import Kind

    x, y, z = eye
    hit = cast_ray(world, x, y, z, 0.0, 1.0, 0.0, 1.0)
    if hit.distance > 0.0:
        return
    inside = (
        "the ground" if hit.solid == TERRAIN_HIT else f"a {Kind(world.solid_kind[hit.solid]).name.lower()}"
    )
    raise UserError(f"position is {x:g},{y:.2f},{z:g}: nothing is seen from inside of {inside}", exit_code=2)
