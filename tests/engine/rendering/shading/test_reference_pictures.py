"""Pictures keep their look: they are compared with those that were looked at and kept in ``reference/``.

Two pictures look the same here if their bytes differ by less than 0.3 of 255 on average, and less than 0.5 %
of them by more than 24. To accept another look, delete the pictures and run this test: it writes them anew.
"""

from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from PIL import Image

from wildscav_engine.maps import generate_map
from wildscav_engine.sensors import ColorCamera
from wildscav_engine.specs.map_spec import MapConfig

FOLDER = Path(__file__).with_name("reference")
CONFIG = MapConfig(size=160, houses=3, storeys=(1, 3), water=0.12, vegetation=0.5, relief=0.8)
SEED = 7
WIDTH, HEIGHT = 320, 180
MEAN, FEW, CLEARLY = 0.3, 0.005, 24
# Of each picture: outdoor or indoor, which of these places, yaw and pitch in degrees.
VIEWS = {
    "beach": ("outdoor", 54, 20.0, 3.0),
    "corner of a room": ("indoor", 9, -60.0, 25.0),
    "corridor": ("indoor", 22, 75.0, 12.0),
    "forest": ("outdoor", 5, 160.0, 3.0),
    "ground": ("outdoor", 11, 200.0, 30.0),
    "house": ("outdoor", 53, 20.0, 3.0),
    "lake": ("outdoor", 31, -100.0, 3.0),
    "sun": ("outdoor", 60, -136.8, -33.7),
}
FAST = ("beach", "corner of a room", "forest", "house", "lake")
CASES = [*((name, "full") for name in VIEWS), *((name, "fast") for name in FAST)]


@pytest.mark.parametrize(("name", "quality"), CASES)
def test_it_looks_as_it_did(name: str, quality: Literal["full", "fast"]) -> None:
    game_map = generate_map(CONFIG, SEED)
    kind, place, yaw, pitch = VIEWS[name]
    places = getattr(game_map, kind)
    eye = places[place * 97 % len(places)] + np.array([0.0, 1.6, 0.0])
    camera = ColorCamera(width=WIDTH, height=HEIGHT, quality=quality)
    taken = camera.render(game_map, [tuple(eye)], [yaw], [pitch])[0]
    path = FOLDER / f"{'fast-' * (quality == 'fast')}{name.replace(' ', '-')}.png"
    if not path.exists():
        Image.fromarray(taken).save(path)
        pytest.fail(f"{path.name} was missing and is written now: look at it, and run this again")
    differences = np.abs(taken.astype(int) - np.asarray(Image.open(path)))
    assert differences.mean() < MEAN
    assert (differences > CLEARLY).mean() < FEW
