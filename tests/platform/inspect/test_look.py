"""``wildscav map look`` as its user meets it."""

import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from tests.commands import Run, run_command

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.viewpoints import viewpoint_of
from wildscav_engine.sensors import SENSORS, ColorCamera, DepthCamera
from wildscav_engine.sensors.display.colors import distance_colors
from wildscav_engine.sensors.optics.dynamic_objects import placed_objects
from wildscav_engine.sensors.optics.image_sensor import ImageSensor
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig

BARE = ("--seed", 3, "--size", 40, "--houses", 0, "--vegetation", 0, "--water", 0)
BARE_MAP = generate_map(MapConfig(size=40, houses=0, vegetation=0.0, water=0.0), 3)
HOUSES = ("--seed", 3, "--size", 60, "--houses", 2)
TINY = ("--width", 32, "--height", 18)
IMAGES = [name for name, kind in SENSORS.items() if issubclass(kind, ImageSensor)]


@pytest.fixture
def look(tmp_path: Path) -> Run:
    """Runs the command in this process, which has the engine loaded, with the temporary folder as its own."""
    return partial(run_command, "map", "look", cwd=tmp_path, columns=200)


def pixels(path: Path) -> NDArray[np.uint8]:
    with Image.open(path) as picture:
        assert picture.mode == "RGB"
        return np.array(picture)


@pytest.mark.parametrize("name", IMAGES)
def test_every_sensor_that_makes_an_image_gives_a_picture(look: Run, tmp_path: Path, name: str) -> None:
    sensor = SENSORS[name]()
    assert isinstance(sensor, ImageSensor)
    size = TINY if name != "lidar" else ()
    height, width = (18, 32) if size else sensor.shape[:2]

    done = look(*HOUSES, "--sensor", name, *size, "--no-legend", "-o", "a.png")
    assert (done.returncode, done.stderr) == (0, "")
    done = look(*HOUSES, "--sensor", name, *size, "-o", "b.png")
    assert (done.returncode, done.stderr) == (0, "")

    plain, explained = pixels(tmp_path / "a.png"), pixels(tmp_path / "b.png")
    assert plain.shape == (height, width, 3)
    assert len(np.unique(plain.reshape(-1, 3), axis=0)) > 2  # there is something to see
    if name in ("camera", "screen"):  # needs no legend, and is never drawn larger
        assert (plain == explained).all()
    else:
        times = explained.shape[1] // width
        assert explained.shape[1] >= 400
        assert (explained[0, ::times] == plain[0]).all()


def test_a_picture_shows_what_the_sensor_reads_from_there(look: Run, tmp_path: Path) -> None:
    options = ("--sensor", "depth", "--option", "far=50", "--field-of-view", 90, *TINY, "--no-legend")
    done = look(*HOUSES, "--position", "-8,20,7", "--yaw", 30, "--pitch", 50, *options, "-o", "a.png")
    assert (done.returncode, done.stderr) == (0, "")
    game_map = generate_map(MapConfig(size=60, houses=2), 3)
    (depth,) = DepthCamera(32, 18, 50.0, 90.0).render(game_map, [(-8, 20, 7)], [30], [50])
    assert (pixels(tmp_path / "a.png") == distance_colors(depth, 50.0)).all()


def test_without_a_height_the_eyes_are_above_the_ground(look: Run) -> None:
    done = look(*BARE, *TINY, "--position", "5.5,-3.25", "-o", "a.png")
    height = ground_at(BARE_MAP.world, 5.5, -3.25).height + EYE_HEIGHT
    assert f"--position 5.50,{height:.2f},-3.25 --yaw 0.0 --pitch 0.0" in done.stdout


def test_without_a_place_a_house_is_looked_at_and_angles_may_still_be_said(
    look: Run,
) -> None:
    view = viewpoint_of(generate_map(MapConfig(size=60, houses=2), 3))
    x, y, z = view.eye
    done = look(*HOUSES, *TINY, "-o", "a.png")
    assert f"--position {x:.2f},{y:.2f},{z:.2f} --yaw {view.yaw:.1f} --pitch {view.pitch:.1f}" in done.stdout
    turned = look(*HOUSES, *TINY, "--yaw", 12, "-o", "a.png")
    assert f"--position {x:.2f},{y:.2f},{z:.2f} --yaw 12.0 --pitch {view.pitch:.1f}" in turned.stdout


def test_what_is_said_is_what_to_say_to_see_the_same_again(look: Run, tmp_path: Path) -> None:
    view = ("--position", "2.5,12.25,-4", "--yaw", 77.5, "--pitch", 12.5)
    done = look(*HOUSES, *TINY, *view, "-o", "a.png")
    said = re.search(r"--position .*", done.stdout)
    assert said is not None
    look(*HOUSES, *TINY, *said.group().split(), "-o", "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_agents_and_boxes_that_are_put_somewhere_are_in_the_picture(look: Run, tmp_path: Path) -> None:
    seen = ("--position", "0,0", "--yaw", 0, *TINY, "-o", "a.png")
    look(*BARE, *seen)
    alone = pixels(tmp_path / "a.png")

    done = look(*BARE, *seen, "--agent", "-1,5,180", "--box", "1,5", "--box", "2,6")

    assert (done.returncode, done.stderr) == (0, "")
    grounds = [(x, ground_at(BARE_MAP.world, x, z).height, z) for x, z in ((-1, 5), (1, 5), (2, 6), (0, 0))]
    (agent, *boxes, (x, y, z)) = grounds
    things = placed_objects([(agent, 180.0)], boxes)
    (image,) = ColorCamera(32, 18).render(BARE_MAP, [(x, y + EYE_HEIGHT, z)], [0], [0], moving=things)
    assert (pixels(tmp_path / "a.png") == image).all()
    assert (image != alone).any()


@pytest.mark.parametrize(("options", "seen"), [((), True), (("--option", "moving=false"), False)])
def test_a_sensor_that_may_leave_them_out_does_so_only_if_told_to(
    look: Run, tmp_path: Path, options: tuple[str, ...], seen: bool
) -> None:
    view = ("--sensor", "depth", "--position", "0,0", *TINY, "-o", "a.png")
    look(*BARE, *view)
    alone = pixels(tmp_path / "a.png")
    look(*BARE, *view, "--box", "0,6", *options)
    assert (pixels(tmp_path / "a.png") != alone).any() == seen


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "a map is named by its ID, or by --seed, --config and the fields of a config"),
        (["1000"], "ID is 1000, must be 1 to 999"),
        (["-5"], "ID is -5, must be 1 to 999"),
        ([*BARE, "--sensor", "nose"], "sensor 'nose' does not exist; sensors that do are depth, lidar, "),
        ([*BARE, "--sensor", "compass"], "sensor 'compass' makes no image; sensors that do are depth, "),
        ([*BARE, "--option", "zoom=2"], "sensor camera: there is no option 'zoom'; its options are width, "),
        ([*BARE, "--option", "far"], "option is 'far', must be KEY=VALUE, such as far=50"),
        ([*BARE, "--option", "=5"], "option is '=5', must be KEY=VALUE"),
        ([*BARE, "--option", "far=5", "--far", 6], "the sensor's option 'far' is given twice"),
        ([*BARE, "--option", "far=5", "--option", "far=6"], "the sensor's option 'far' is given twice"),
        ([*BARE, "--option", "far=wide"], "sensor camera: far: Input should be a valid number"),
        ([*BARE, "--far", "nan"], "sensor camera: far: "),
        ([*BARE, "--width", 0], "sensor camera: width: Input should be greater than or equal to 1, not 0"),
        ([*BARE, "--width", 1921], "width: Input should be less than or equal to 1920, not 1921"),
        ([*BARE, "--sensor", "lidar", "--width", 9], "sensor lidar: there is no option 'width'"),
        ([*BARE, "--sensor", "segmentation", "--option", "label=name"], "label: Input should be 'kind' or "),
        ([*BARE, "--position", "3"], "position is '3', must be X,Z or X,Y,Z, numbers in metres"),
        ([*BARE, "--position", "1,2,3,4"], "position is '1,2,3,4', must be X,Z or X,Y,Z"),
        ([*BARE, "--position", "a,b"], "position is 'a,b', must be X,Z or X,Y,Z"),
        ([*BARE, "--position", "nan,2"], "position is 'nan,2', must be X,Z or X,Y,Z"),
        ([*BARE, "--position", "20,2"], "position is 20,2, must be within -20 to 20 m"),
        ([*BARE, "--position", "2,-90,3"], "2,-90.00,3: nothing can be seen inside the ground"),
        ([*HOUSES, "--position", "-10.687,4.37,6.259"], "nothing can be seen inside a wall"),
        ([*BARE, "--yaw", 361], "yaw is 361, must be -360 to 360 degrees"),
        ([*BARE, "--pitch", "91"], "pitch is 91, must be -90 to 90 degrees"),
        ([*BARE, "--pitch", "nan"], "pitch is nan, must be -90 to 90 degrees"),
        ([*BARE, "--agent", "3,4"], "agent is '3,4', must be X,Z,YAW or X,Y,Z,YAW"),
        ([*BARE, "--agent", "3,44,0"], "agent is 3,44, must be within -20 to 20 m"),
        ([*BARE, "--box", "3"], "box is '3', must be X,Z or X,Y,Z"),
        ([*BARE, "--box", "-33,4"], "box is -33,4, must be within -20 to 20 m"),
        ([*BARE, "-o", "a.gif"], "a.gif must end in one of .png"),
    ],
)
def test_what_cannot_be_is_one_line_and_writes_nothing(
    look: Run, tmp_path: Path, arguments: list[object], message: str
) -> None:
    done = look(*arguments)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done
    assert done.stderr.startswith("wildscav: ")
    assert message in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_missing_is_named_and_an_older_picture_is_kept_whole(
    look: Run, tmp_path: Path
) -> None:
    done = look(*BARE, *TINY, "-o", tmp_path / "none" / "a.png")
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert "No such file or directory" in done.stderr
    (tmp_path / "a.png").write_bytes(b"older")
    look(*BARE, *TINY, "-o", "a.png")
    assert pixels(tmp_path / "a.png").shape == (18, 32, 3)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
