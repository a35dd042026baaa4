"""The suite of short matches that readers, people and programs play alike, with one rating across its tracks.

A seat of words decides at most about 60 times in a match: see ``benchmarks/strength/reading.py``. The clock
is paused, and one submission meets robots, always in seat 0.
"""

from collections.abc import Callable

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import NAMED
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave
from wildscav_evaluator.suites.match_drawing import choose
from wildscav_evaluator.suites.suite import Reference, Suite, TrackSettings
from wildscav_evaluator.suites.wild import FAIR_RULES

WALKING_TIME = 120.0  # s, to find a target
GATHERING_TIME, HOT_SPOT_TIME = 75.0, 25.0  # s, of a match with supplies, and of a place of its hot spot
ROYALE_TIME = 90.0  # s
MATCHES = 6  # on each track: with fewer, no two submissions can be told apart
RULES = NAMED["fair"]
FEW_BOXES = SupplyWave(center=(0.0, 0.0), radius=60.0, outdoor_richness=2.0, indoor_richness=2.0)


def open_country(*sizes: int) -> Callable[[RandomStream], MapConfig]:
    """Return a function that draws the configs of maps, of some sizes, m, of hills with few houses."""

    def draw(dice: RandomStream) -> MapConfig:
        size = choose(dice, sizes)
        return MapConfig(
            size=size,
            houses=size // 30,
            storeys=(1, 2),
            relief=choose(dice, (0.4, 0.6, 0.8)),
            ruggedness=choose(dice, (0.2, 0.4)),
            vegetation=choose(dice, (0.3, 0.5)),
        )

    return draw


def divided_country(dice: RandomStream) -> MapConfig:
    """Return the config of a map with barriers that have gates, gaps, passes and ramps."""
    return LEVELS[choose(dice, ("severe", "brutal"))]


def supplies_at_hot_spots() -> SupplyConfig:
    """Return few boxes all over the map, and a hot spot that moves twice."""
    places = round(GATHERING_TIME / HOT_SPOT_TIME)
    hot_spot = HotSpot(interval=HOT_SPOT_TIME, places=places, radius=6.0, boxes=8, quantity=(10, 30))
    return SupplyConfig(waves=(FEW_BOXES,), spacing=5.0, outdoor_quantity=(1, 3), hot_spot=hot_spot)


def settings(
    map_config: Callable[[RandomStream], MapConfig], robots: tuple[str, ...] = (), **match: object
) -> TrackSettings:
    """Return the settings of a track whose matches differ only in their maps and seeds."""
    spec = MatchSpec.model_validate(
        {"rules": RULES, **match, "seats": (SUBMISSION, *robots), "clock": "paused"}
    )
    return TrackSettings(maps=MATCHES, episodes=1, draw=lambda _: spec, map_config=map_config)


READING = Suite(
    name="reading",
    title="short matches with few decisions, for readers, people and programs, rated across all tracks",
    map_config=open_country(100),
    tracks={
        "navigation": settings(divided_country, track="navigation", time_limit=WALKING_TIME),
        "gathering": settings(
            open_country(120),
            ("gatherer-easy",) * 3,
            track="gathering",
            time_limit=GATHERING_TIME,
            supplies=supplies_at_hot_spots(),
        ),
        "capture": settings(open_country(140, 160, 180), track="capture", time_limit=WALKING_TIME),
        "battle": settings(
            open_country(100),
            ("fighter-easy", "gatherer-easy") * 3,
            track="battle",
            time_limit=GATHERING_TIME,
            supplies=supplies_at_hot_spots(),
            rules=FAIR_RULES,
        ),
        "royale": settings(
            open_country(100),
            ("fighter",) * 3 + ("fighter-easy",) * 2,
            track="royale",
            time_limit=ROYALE_TIME,
            supplies=SupplyConfig(waves=(FEW_BOXES,), spacing=5.0, outdoor_quantity=(1, 3)),
            rules=RULES._replace(spare_ammo=300),
        ),
    },
    # The means of 18 matches in benchmarks/results/reading.json, which
    # ``python -m benchmarks.strength.reading --rounds 3`` played.
    references={
        "navigation": Reference("mapper", 138.3, 11.32),
        "gathering": Reference("homing", 7.5, 242.28),
        "capture": Reference("homing", 127.37, 54.09),
        "battle": Reference("commando", 15.0, 313.44),
        "royale": Reference("commando", 42.28, 80.17),
    },
)
