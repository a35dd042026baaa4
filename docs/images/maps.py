# ruff: noqa: INP001 - a script, not part of a package
"""Make the gallery of docs/maps.md: twelve maps from above, and one house cut open at each storey.

    python docs/images/maps.py

needs ``pip install 'wildscav[maps]'``. Run it again whenever the version of the map generator rises.
"""

import sys
from pathlib import Path

from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.picture import draw_map
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


def main() -> None:
    """Draw all pictures and print their total size."""
    FOLDER.mkdir(exist_ok=True)
    for number in BENCHMARK:
        _draw(f"{number:03}", _load(number), f"Map {number:03}")
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
    weight = sum(path.stat().st_size for path in FOLDER.glob("*.jpg"))
    sys.stdout.write(f"{FOLDER}: {weight / 1e6:.2f} MB\n")


def _draw(name: str, game_map: GameMap, title: str) -> None:
    picture = draw_map(game_map, width=WIDTH, title=title)
    picture.save(FOLDER / f"{name}.jpg", quality=QUALITY, optimize=True)


def _load(number: int) -> GameMap:
    from wildscav_engine.maps import load_map

    return load_map(number)


if __name__ == "__main__":
    main()
