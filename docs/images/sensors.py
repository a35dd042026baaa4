# ruff: noqa: INP001 - a script, not part of a package
"""Make camera.jpg, the picture at the top of the README, and the pictures of docs/sensors.md.

    python docs/images/sensors.py

needs ``pip install 'wildscav[maps]'``. Run it again whenever the map generator or the camera changes.
"""

import sys
from pathlib import Path
from typing import Any

from numpy.typing import NDArray
from PIL import Image

from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.viewpoints import standing_height
from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.sensors import (
    ColorCamera,
    DepthCamera,
    Lidar,
    NormalCamera,
    Screen,
    SegmentationCamera,
)
from wildscav_engine.sensors.display.legend import draw_reading
from wildscav_engine.sensors.optics.dynamic_objects import placed_objects
from wildscav_engine.sensors.optics.image_sensor import ImageSensor
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec

FOLDER = Path(__file__).parent
CONFIG = MapConfig(
    size=120, relief=1.2, ruggedness=0.5, water=0.16, houses=5, storeys=(2, 3), vegetation=0.55
)
SEED = 5
AGENTS = ((-0.5, 37.2, 250.0), (4.0, 34.2, 200.0), (22.5, -22.0, 150.0))  # x, z in m, yaw in degrees
BOXES = ((-3.6, 36.9), (1.5, 35.5), (24.5, -26.0), (21.0, -20.0))  # x, z in m
SHORE = (-10.0, 38.0, 104.0, 1.5)  # x, z in m, yaw and pitch in degrees
GARDEN = (23.0, -33.0, 357.0, 1.0)
ROOM = (-35.0, -35.5, 279.8, 3.0)

HERO, QUALITY = (1280, 720), 86  # pixels, and quality of the JPEG, which has about 200 kB
SIZE = (448, 252)  # pixels of the other pictures; as PNG they have less than 150 kB
FAR, ANGLE = 100.0, 72.0  # m, degrees


def main() -> None:
    """Make all pictures and print their sizes."""
    game_map = generate_map(CONFIG, SEED)
    objects = placed_objects(
        [(_ground(game_map, x, z), yaw) for x, z, yaw in AGENTS],
        [_ground(game_map, x, z) for x, z in BOXES],
    )
    hero = _photograph(game_map, objects, SHORE, HERO)
    hero.save(FOLDER / "camera.jpg", quality=QUALITY, optimize=True)
    folder = FOLDER / "sensors"
    folder.mkdir(exist_ok=True)
    for name, place in (("camera", GARDEN), ("inside", ROOM)):
        picture = _photograph(game_map, objects, place, SIZE)
        picture.save(folder / f"{name}.png", optimize=True)
    for sensor in (
        DepthCamera(*SIZE, FAR, ANGLE, moving=True),
        NormalCamera(*SIZE, FAR, ANGLE, moving=True),
        SegmentationCamera(*SIZE, FAR, ANGLE),
        Lidar(64, 900, lowest=-20.0, highest=20.0, moving=True),
    ):
        reading = _look(sensor, game_map, objects, GARDEN)
        draw_reading(sensor, reading).save(folder / f"{sensor.name}.png", optimize=True)
    Image.fromarray(_screen(game_map)).save(folder / "screen.png", optimize=True)
    for path in (FOLDER / "camera.jpg", *sorted(folder.glob("*.png"))):
        sys.stdout.write(f"{path.relative_to(FOLDER)}: {path.stat().st_size / 1e3:.0f} kB\n")


def _photograph(
    game_map: GameMap,
    objects: DynamicObjects,
    place: tuple[float, float, float, float],
    size: tuple[int, int],
) -> Image.Image:
    """Take a colour picture at a larger size and scale it down for smooth edges."""
    larger = min(3, 1920 / size[0])
    camera = ColorCamera(round(size[0] * larger), round(size[1] * larger), field_of_view=ANGLE)
    picture = Image.fromarray(_look(camera, game_map, objects, place))
    return picture.resize(size, Image.Resampling.LANCZOS)


def _screen(game_map: GameMap) -> NDArray[Any]:
    """Return the screen of an agent in a battle that has just been hit."""
    match = Match(MatchSpec(track="battle", map=game_map.spec, seats=("submission",) * 3), game_map)
    agents = match.state.agents
    places = (GARDEN, *((x, z, yaw, 0.0) for x, z, yaw in ((23.5, -24.0, 180.0), (19.5, -21.0, 150.0))))
    for seat, (x, z, yaw, pitch) in enumerate(places):
        agents.position[0, seat] = _ground(game_map, x, z)
        agents.yaw[0, seat], agents.pitch[0, seat] = yaw, pitch
    agents.invincible_left[:] = 0
    agents.health[0, 0], agents.supplies[0, 0], agents.clip[0, 0] = 60, 12, 7
    agents.hit_by_seat[0, 0] = 1
    return Screen(320, 240, field_of_view=ANGLE).read(match, [0])[0]


def _look(
    sensor: ImageSensor,
    game_map: GameMap,
    objects: DynamicObjects,
    place: tuple[float, float, float, float],
) -> NDArray[Any]:
    """Return the reading of a sensor at the eyes of an agent that stands at a place."""
    x, z, yaw, pitch = place
    _, y, _ = _ground(game_map, x, z)
    return sensor.render(game_map, [(x, y + EYE_HEIGHT, z)], [yaw], [pitch], moving=objects)[0]


def _ground(game_map: GameMap, x: float, z: float) -> tuple[float, float, float]:
    return x, standing_height(game_map.world, x, z), z


if __name__ == "__main__":
    main()
