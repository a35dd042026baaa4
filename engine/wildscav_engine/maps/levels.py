"""The levels of difficulty: configs of random maps, from open ground to mazes with hidden targets.

They are frozen: a result on a level can be compared with any other on it. From "tough" on there are barriers
to find a way through: first few on a small map, then more, and at last ones that have no way.
"""

from typing import Literal

from wildscav_engine.specs.map_spec import Country, MapConfig

Level = Literal["easy", "normal", "hard", "tough", "severe", "brutal", "extreme", "expert"]


def _land(size: int, houses: int, country: Country) -> MapConfig:
    """Return low hills with a few houses and barriers."""
    return MapConfig(
        size=size, relief=0.5, ruggedness=0.2, water=0.03, houses=houses, storeys=(1, 3), country=country
    )


def _wards(ward: int, loops: float) -> Country:
    """Return wards of all kinds, without towns, and with targets anywhere."""
    return Country(ward=ward, loops=loops, towns=0, hidden_targets=False)


LEVELS: dict[Level, MapConfig] = {
    # Open and nearly flat: the target is visible from afar.
    "easy": MapConfig(
        size=100, relief=0.3, ruggedness=0.1, water=0.0, houses=2, storeys=(1, 1), vegetation=0.2
    ),
    "normal": MapConfig(size=200, houses=8),
    # Streets between high houses, cliffs, lakes and woods.
    "hard": MapConfig(
        size=300,
        relief=1.5,
        ruggedness=0.8,
        water=0.15,
        houses=16,
        density="high",
        storeys=(1, 3),
        vegetation=0.7,
    ),
    # Four wards, and a way through each border between them: a gate, a gap, a pass or a ramp.
    "tough": _land(80, 2, _wards(40, 1.0)),
    "severe": _land(200, 6, _wards(100, 1.0)),
    # Many wards on the way.
    "brutal": _land(200, 6, _wards(40, 1.0)),
    # More of them, and about half of the borders that could be closed are.
    "extreme": _land(200, 6, _wards(26, 0.5)),
    # Few ways, which are much longer than the straight line, a town of narrow streets, and hidden targets.
    "expert": _land(200, 6, Country()),
}
