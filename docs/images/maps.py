# ruff: noqa: INP001 - a script, not part of a package
"""Make the pictures of docs/maps.md: maps from above, a house cut open at each storey, views at eye height.

    python docs/images/maps.py

needs ``pip install 'wildscav[maps]'``. Run it again whenever the version of the map generator rises.
"""

import math
import sys
from pathlib import Path

from PIL import Image

from wildscav_engine.maps import GameMap, generate_map, load_map
from wildscav_engine.maps.country import plan_country
from wildscav_engine.maps.country.wards import Barrier
from wildscav_engine.maps.ground.terrain import make_terrain
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.maps.picture import draw_map
from wildscav_engine.maps.viewpoints import standing_height
from wildscav_engine.sensors import parse_sensors
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig

FOLDER = Path(__file__).parent / "maps"
WIDTH, HOUSE_WIDTH = 900, 500  # pixels
QUALITY = 84  # of the JPEGs, which have about 200 kB each

BENCHMARK = (8, 14, 101, 102, 103, 104)
VARIETY = {
    "hamlet": (MapConfig(size=80, houses=5, relief=0.6), 7),
    "mountains": (
        MapConfig(size=500, relief=2.0, ruggedness=1.0, houses=6, water=0.05, vegetation=0.3),
        21,
    ),
    "town": (
        MapConfig(size=300, density="high", houses=40, storeys=(1, 4), relief=0.5, water=0.03),
        4,
    ),
    "lakes": (MapConfig(size=400, water=0.35, houses=10, relief=0.8, ruggedness=0.1, vegetation=0.6), 12),
    "woods": (MapConfig(size=200, houses=3, vegetation=1.0, relief=1.2), 33),
    "wide": (MapConfig(size=1000, houses=60, storeys=(1, 3), relief=1.3), 2),
}
CUT_HOUSE, CUT_STOREYS = (MapConfig(size=80, houses=3, storeys=(3, 3), relief=0.4, water=0.0), 6), 3
SPAN = 20.0  # m, the width of the picture of that house
EXPERT_SEED, EYES = 4, {"width": 480, "height": 270}
APPROACH = -9.0  # m beside the border from which a gate is seen


def main() -> None:
    """Draw all pictures and print their total size."""
    FOLDER.mkdir(exist_ok=True)
    for number in BENCHMARK:
        _draw(f"{number:03}", load_map(number), f"Map {number:03}")
    for name, (config, seed) in VARIETY.items():
        _draw(name, generate_map(config, seed), name.capitalize())
    game_map = generate_map(*CUT_HOUSE)
    for storey in range(1, CUT_STOREYS + 1):
        picture = draw_map(
            game_map,
            width=HOUSE_WIDTH,
            storey=storey,
            center=game_map.houses[0].center,
            span=SPAN,
            title=f"Storey {storey}",
        )
        picture.save(FOLDER / f"storey-{storey}.jpg", quality=QUALITY, optimize=True)
    _draw_expert()
    weight = sum(path.stat().st_size for path in FOLDER.glob("*.jpg"))
    sys.stdout.write(f"{FOLDER}: {weight / 1e6:.2f} MB\n")


def _draw(name: str, game_map: GameMap, title: str) -> None:
    picture = draw_map(game_map, width=WIDTH, title=title)
    picture.save(FOLDER / f"{name}.jpg", quality=QUALITY, optimize=True)


def _draw_expert() -> None:
    """Draw a map of level expert from above, and one way through each of its kinds of barriers."""
    config = LEVELS["expert"]
    game_map = generate_map(config, EXPERT_SEED)
    _draw("expert", game_map, "Level expert")
    plan = plan_country(config, EXPERT_SEED, make_terrain(config, EXPERT_SEED))
    assert plan is not None  # noqa: S101 - the level has country
    ways = {border.barrier: border for border in plan.wards.borders if border.gate is not None}
    eyes, yaws = [], []
    for barrier in (Barrier.WALL, Barrier.THICKET, Barrier.RIDGE, Barrier.CLIFF):
        gate = ways[barrier].gate or 0.0
        (x, z), (to_x, to_z) = ways[barrier].at(gate - 3.0, APPROACH), ways[barrier].at(gate)
        eyes.append((x, standing_height(game_map.world, x, z) + EYE_HEIGHT, z))
        yaws.append(math.degrees(math.atan2(to_x - x, to_z - z)))
    camera = parse_sensors({"camera": EYES})["camera"]
    views = camera.render(game_map, eyes, yaws, [3.0] * len(eyes))
    sheet = Image.new("RGB", (2 * EYES["width"], 2 * EYES["height"]))
    for number, view in enumerate(views):
        corner = (number % 2 * EYES["width"], number // 2 * EYES["height"])
        sheet.paste(Image.fromarray(view[..., :3]), corner)
    sheet.save(FOLDER / "expert-eyes.jpg", quality=QUALITY, optimize=True)


if __name__ == "__main__":
    main()
