"""What the page of sensors says is true, and the sensor that it adds works from its file to the agent."""

import ast
import importlib.util
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.builders import box, flat_world, make_match, place
from tests.end_to_end.pages import run_code
from tests.platform.helpers.seats import ended, host, serving, small_spec, start_agent

from wildscav_engine.extensions import BUILT_IN
from wildscav_engine.geometry.world import Kind
from wildscav_engine.sensors import SENSORS, DepthCamera
from wildscav_engine.sensors.base import Sensor
from wildscav_engine.sensors.optics.segmentation import FIRST_AGENT, FIRST_BOX, FIRST_SOLID
from wildscav_server.hosting.manifest import Manifest
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "sensors.md"
TEXT = PAGE.read_text("utf-8")
CAMERAS = ("depth", "segmentation", "normals", "camera")
EXAMPLES = ROOT / "docs" / "examples"
MANIFEST = """\
name = "jumper"
version = "1.0.0"
entry_point = "agent:Jumper"
tracks = ["gathering"]

[sensors.altimeter]
reach = 20.0
"""
AGENT = """\
import sys
from wildscav import Action, Agent


class Jumper(Agent):
    def act(self, observation):
        reading = observation.sensor("altimeter")
        print(observation.position[1], reading.dtype, *reading, file=sys.stderr)
        return Action(jump=reading[0] < 0.01)
"""
PATIENT = Clock(step_budget=20.0, time_bank=60.0)


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)


def test_the_page_tells_every_sensor_with_its_class() -> None:
    rows = re.findall(r"^\| `(\w+)` \| `(\w+)` \| [^|]+ \|$", TEXT, re.MULTILINE)
    assert rows == [(name, SENSORS[name].__name__) for name in SENSORS]


def test_the_page_tells_the_labels_of_segmentation() -> None:
    flat = " ".join(TEXT.split())
    kinds = ", ".join(f"{kind.value} {kind.name.lower().replace('_', ' ')}" for kind in Kind)
    assert f"by `kind`: {kinds}." in flat
    for thing, first in (("agent", FIRST_AGENT), ("part of the map", FIRST_SOLID), ("supply box", FIRST_BOX)):
        assert f"{thing} {first} + its " in flat


def test_the_code_and_the_manifests_of_the_page_work(tmp_path: Path) -> None:
    assert run_code(blocks("python")[0], tmp_path) == "(2, 36, 64)\n(3, 36, 64) float32\n"
    asked = Manifest.model_validate(tomllib.loads(blocks("toml")[0])).sensors
    assert set(asked) == {"depth", "lidar", "segmentation"}


def test_the_pictures_of_the_page_are_small() -> None:
    pictures = list((PAGE.parent / "images" / "sensors").glob("*.png"))
    assert {path.stem for path in pictures} == {*CAMERAS, "screen", "lidar", "inside"}
    for path in pictures:
        assert path.stat().st_size < 150_000, path.name
        assert f"images/sensors/{path.name}" in TEXT


def module_of(file: Path) -> Any:
    """Import a program of the examples."""
    spec = importlib.util.spec_from_file_location(file.stem, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def altimeter(monkeypatch: pytest.MonkeyPatch) -> type[Sensor]:
    """The sensor that the page adds, from its file, in the registry by the line that the page gives."""
    _, line = blocks("python")
    module = module_of(EXAMPLES / "altimeter.py")
    ((name, home),) = re.findall(r'^"(\w+)": "([\w.]+):\w+",$', line, re.MULTILINE)
    monkeypatch.setitem(sys.modules, home, module)
    listed = dict(BUILT_IN[SENSORS.group])
    (text,) = ast.literal_eval("{" + line + "}").values()
    monkeypatch.setattr(SENSORS, "_built_in", listed | {name: text})
    monkeypatch.setattr(SENSORS, "_made", {})
    return SENSORS[name]


@pytest.mark.slow
def test_a_sensor_that_is_added_reaches_an_agent_over_the_wire(
    tmp_path: Path, altimeter: type[Sensor]
) -> None:
    """An agent that tells what it reads plays in its own process."""
    manifest = Manifest.model_validate(tomllib.loads(MANIFEST))
    (tmp_path / "agent.py").write_text(AGENT, "utf-8")

    async def play(server: MatchServer, address: str) -> list[tuple[float, str, float]]:
        hosted = await host(
            server, small_spec(manifest.tracks[0]), sensors={0: manifest.sensors}, clock=PATIENT
        )
        agent = await start_agent(manifest.entry_point, address, hosted.tokens[0], folder=tmp_path)
        code, said = await ended(agent)
        assert code == 0, said
        assert (await hosted.finished()).seats[0].status == SeatStatus.FINISHED
        lines = [line.split() for line in said.splitlines()]
        return [(float(height), dtype, float(reading)) for height, dtype, reading in lines]

    told = serving(tmp_path, play)

    assert len(told) == 20  # one a step, two seconds
    heights, dtypes, readings = zip(*told, strict=True)
    ground = heights[0]  # it jumps on the spot
    assert set(dtypes) == {"float32"}
    assert readings == pytest.approx([height - ground for height in heights], abs=1e-4)
    assert readings[0] == pytest.approx(0.0, abs=1e-4)
    assert max(readings) > 1.0  # a jump is 1.27 m high


def test_a_sensor_that_is_added_is_refused_as_all_others_are(altimeter: type[Sensor]) -> None:
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"reach": 0}, "sensor altimeter: reach: Input should be greater than 0, not 0"),
        ({"depth": 3}, "sensor altimeter: there is no option 'depth'; its options are reach"),
    ]
    for options, message in wrong:
        manifest = tomllib.loads(MANIFEST) | {"sensors": {"altimeter": options}}
        with pytest.raises(ValueError, match=re.escape(message)):
            Manifest.model_validate(manifest)


@pytest.mark.parametrize(
    ("place_of", "height"),
    [
        ((9.0, 0.0, 9.0), 0.0),  # on the ground
        ((9.0, 2.5, 9.0), 2.5),  # in a jump
        ((0.0, 5.0, 0.0), 2.0),  # over a roof of 3 m
        ((0.0, 30.0, 0.0), 20.0),  # farther than it reaches
    ],
)
def test_the_sensor_that_is_added_reads_what_it_says(
    altimeter: type[Sensor], place_of: tuple[float, float, float], height: float
) -> None:
    match = make_match(world=flat_world(solids=[box((-2, 0, -2), (2, 3, 2), Kind.ROOF)]), seats=2)
    place(match, 1, place_of)
    sensor = altimeter(reach=20.0)  # type: ignore[call-arg]
    _, reading = sensor.read(match, [0, 1])
    assert reading == pytest.approx(height, abs=1e-5)
    assert sensor.space.contains(reading)


def test_the_sensor_that_is_added_takes_the_surface_of_a_lake_for_the_ground(altimeter: type[Sensor]) -> None:
    match = make_match(world=flat_world(water=1.5), seats=2)
    place(match, 0, (3.0, 4.0, 3.0))
    place(match, 1, (3.0, 0.5, 3.0))  # in the water
    assert altimeter().read(match, [0, 1])[:, 0] == pytest.approx([2.5, 0.0], abs=1e-6)


def test_the_camera_that_is_added_measures_along_rays_what_the_depth_camera_measures_ahead() -> None:
    camera = module_of(EXAMPLES / "range_camera.py").RangeCamera
    match = make_match(world=flat_world(solids=[box((-90, 0, 8), (90, 30, 9), Kind.WALL)]), seats=2)
    place(match, 1, (3.0, 0.0, 2.0), 20.0)
    lens = {"width": 9, "height": 1, "field_of_view": 90.0, "far": 7.0}

    ranges, depths = camera(**lens).read(match, [1, 0]), DepthCamera(**lens).read(match, [1, 0])

    aside = (np.arange(9) - 4) * 2 / 9
    near = ranges < 7.0
    assert near.sum() == 5
    assert ranges == pytest.approx(np.where(near, depths * np.sqrt(1 + aside**2), 7.0), rel=1e-6)
    assert camera(**lens).space.contains(ranges[0])
