"""What holds for every sensor, whatever it is: a sensor that joins the registry is tested unasked."""

import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
from tests.builders import make_match

from wildscav_engine.maps import generate_map
from wildscav_engine.sensors import SENSORS, DepthCamera, parse_sensor
from wildscav_engine.sensors.optics.image_sensor import ImageSensor
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import Field, no_actions
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec

COUNTRY = generate_map(MapConfig(size=60, houses=2, water=0.1, vegetation=0.8), seed=3)
# Options that differ from the defaults, none of them round. A sensor without an entry is read as it is.
ODD: dict[str, list[dict[str, object]]] = {
    "depth": [
        {"width": 1, "height": 1},
        {"width": 7, "height": 3, "far": 0.3, "field_of_view": 170.0, "moving": True},
    ],
    "lidar": [
        {"channels": 1, "azimuths": 1},
        {"channels": 3, "azimuths": 7, "range": 0.3, "lowest": -90.0, "highest": 90.0, "moving": True},
    ],
    "normals": [{"width": 7, "height": 3, "far": 33.3, "moving": True}],
    "camera": [{"width": 7, "height": 3, "far": 33.3}],
    "screen": [{"width": 7, "height": 3, "far": 33.3}, {"width": 483, "height": 301, "quality": "fast"}],
    "segmentation": [
        {"width": 7, "height": 3, "label": "instance"},
        {"width": 5, "height": 9, "label": "kind"},
    ],
    "visible_agents": [{"limit": 1}, {"limit": 3}],
    "sights": [{"limit": 1}, {"limit": 16, "lead": 0.5}],
    "to_supplies": [{"limit": 1, "worth": 0.0, "start_up": 0.0}, {"limit": 32, "worth": 2.0}],
    "teammates": [{"limit": 1}, {"limit": 64}],
    "nearby_supplies": [{"range": 3.3, "limit": 2}, {"range": 200.0}],
}
CASES = [
    pytest.param(name, options, id=f"{name}-{number}")
    for name in SENSORS
    for number, options in enumerate([{}, *ODD.get(name, [])])
]


TRACKS = ("navigation", "gathering", "battle", "royale")


def played(track: str) -> Match:
    """A match in the middle of it: agents that fight, walk and fall, and boxes around them."""
    armed = track in ("battle", "royale")
    seats = ("submission", *(("fighter", "fighter", "gatherer", "walker") if armed else ()))
    match = Match(MatchSpec(track=track, map=COUNTRY.spec, seed=1, seats=seats), COUNTRY)
    actions = no_actions(match.seats)
    actions[:, Field.WALK_SPEED], actions[:, Field.TURN], actions[:, Field.LOOK] = 4.0, 3.0, 1.0
    for _ in range(60):
        match.step(actions)
    return match


@pytest.fixture(scope="module")
def matches() -> dict[str, Match]:
    return {track: played(track) for track in TRACKS}


@pytest.mark.parametrize("track", TRACKS)
@pytest.mark.parametrize(("name", "options"), CASES)
def test_every_reading_is_in_its_space_and_what_its_seat_reads_alone(
    name: str, options: dict[str, object], track: str, matches: dict[str, Match]
) -> None:
    sensor, match = parse_sensor(name, options), matches[track]
    seats = range(match.seats)[::-1]

    readings = sensor.read(match, seats)

    assert readings.shape == (match.seats, *sensor.space.shape)
    assert readings.dtype == sensor.space.dtype
    for seat, reading in zip(seats, readings, strict=True):
        assert sensor.space.contains(reading), (reading.min(), reading.max())
        assert sensor.read(match, [seat])[0].tobytes() == reading.tobytes()
    assert sensor.read(match, []).shape == (0, *sensor.space.shape)
    for seat in (-1, match.seats):
        said = rf"there is no seat {seat}; the seats are 0 to {match.seats - 1}"
        with pytest.raises(ValueError, match=said):
            sensor.read(match, [0, seat])


def test_reading_changes_nothing_in_the_match_and_a_reading_is_nobody_elses() -> None:
    alone, read = played("battle"), played("battle")
    sensors = [parse_sensor(*case.values) for case in CASES]  # type: ignore[arg-type]
    for _ in range(5):
        first = [sensor.read(read, range(read.seats)) for sensor in sensors]
        kept = [reading.tobytes() for reading in first]
        assert all(reading.flags.c_contiguous for reading in first)
        assert [sensor.read(read, range(read.seats)).tobytes() for sensor in sensors] == kept
        read.step()
        alone.step()
        for sensor in sensors:
            sensor.read(read, [1])
        assert [reading.tobytes() for reading in first] == kept
    assert read.digests == alone.digests
    for mine, other in zip((*read.state, read.seen), (*alone.state, alone.seen), strict=True):
        for field in mine._fields:
            np.testing.assert_array_equal(getattr(mine, field), getattr(other, field))


@pytest.mark.parametrize("name", SENSORS)
def test_every_sensor_says_what_it_is(name: str) -> None:
    kind = SENSORS[name]
    assert kind.name == name
    assert kind.title
    assert "\n" not in kind.title
    assert kind.__doc__
    assert kind() == parse_sensor(name, {})
    assert hash(kind()) == hash(parse_sensor(name, {}))


@pytest.mark.parametrize("name", SENSORS)
def test_a_sensor_cannot_be_changed(name: str) -> None:
    with pytest.raises(AttributeError):
        SENSORS[name]().name = "other"  # type: ignore[misc]


@pytest.mark.parametrize("name", SENSORS)
@pytest.mark.parametrize("option", ["nose", "self", "__dataclass_self__", "name", "title", "dtype", "a\nb"])
def test_an_option_that_there_is_not_is_named_in_one_line(name: str, option: str) -> None:
    with pytest.raises(ValueError, match=f"^sensor {name}: there is no option ") as caught:
        parse_sensor(name, {option: 1})
    assert repr(option) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "its options are" in str(caught.value) or "it has no options" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("depth", {"width": 0}, "width: Input should be greater than or equal to 1, not 0"),
        ("depth", {"far": -1}, "far"),
        ("depth", {"height": "tall"}, "height"),
        ("camera", {"shadows": "perhaps"}, "shadows"),
        ("segmentation", {"label": "colour"}, "label: Input should be 'kind' or 'instance'"),
        ("lidar", {"lowest": 10, "highest": -10}, "lowest is 10, must not be above highest, -10"),
        ("lidar", {"channels": 0}, "channels: Input should be greater than or equal to 1, not 0"),
        ("lidar", {"azimuths": 4000}, "azimuths: Input should be less than or equal to 3600"),
        ("lidar", {"range": float("inf")}, "range: Input should be a finite number"),
        ("lidar", {"highest": 91}, "highest: Input should be less than or equal to 90"),
    ],
)
def test_an_option_that_is_not_allowed_is_named_in_one_line(
    name: str, options: dict[str, object], said: str
) -> None:
    with pytest.raises(ValueError, match=f"^sensor {name}: ") as caught:
        parse_sensor(name, options)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_sensor_that_there_is_not_is_answered_with_those_there_are() -> None:
    with pytest.raises(ValueError, match="there is no sensor 'nose'; the sensors are depth, ") as caught:
        parse_sensor("nose", {})
    assert all(name in str(caught.value) for name in SENSORS)


@pytest.mark.slow
def test_a_server_that_is_warm_compiles_nothing_for_any_sensor() -> None:
    wanted = [case.values for case in CASES]
    code = f"""
        import gc
        from numba.core.dispatcher import Dispatcher
        from tests.builders import make_match
        from wildscav_server.hosting.precompile import precompile
        from wildscav_engine.sensors import parse_sensor

        def kernels():
            found = [item for item in gc.get_objects() if isinstance(item, Dispatcher)]
            return {{(item.py_func.__name__, str(types)) for item in found for types in item.signatures}}

        precompile()
        match = make_match("battle", seats=3)
        match.step()
        before = kernels()
        assert before
        for name, options in {wanted!r}:
            parse_sensor(name, options).read(match, [0, 2])
        print(sorted(kernels() - before))
    """
    folder = Path(__file__).parents[3]
    done = subprocess.run([sys.executable, "-c", dedent(code)], cwd=folder, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "[]\n"), done.stderr


def test_only_sensors_of_images_prepare_the_scene_of_a_map() -> None:
    match = make_match("battle")
    match.step()
    for kind in SENSORS.values():
        if not issubclass(kind, ImageSensor):
            kind().read(match, [0])
    assert "scene" not in vars(match.game_map)
    DepthCamera().read(match, [0])
    assert "scene" in vars(match.game_map)


@pytest.mark.parametrize("name", SENSORS)
def test_the_columns_of_a_sensor_are_those_of_its_space(name: str) -> None:
    sensor = SENSORS[name]()
    space = sensor.space
    if sensor.rays:  # its pixels are alike
        assert sensor.columns == ()
        return
    assert len(sensor.columns) == space.shape[-1]
    for place, column in enumerate(sensor.columns):
        assert (space.low[..., place] == np.float32(column.low)).all(), column
        assert (space.high[..., place] == np.float32(column.high)).all(), column
        assert column.name, column
        assert column.meaning, column
    assert len({column.name for column in sensor.columns}) == len(sensor.columns)
