"""Thickets: hedges with trees in them, too dense to walk through and too high to jump, with gaps."""

from collections.abc import Sequence

from wildscav_engine.arithmetic.random_numbers import Dice, Stream
from wildscav_engine.geometry.shapes import polygon, stack
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.country.wards import Barrier, Border
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.streets import height_at

GAP = 3.4  # m between the axes of the outermost bushes of a gap, less their radii
STEP = 1.25  # m from one bush to the next: they overlap by far
RADIUS = (1.0, 1.35)  # m, of bushes
HEIGHT = (2.3, 3.3)  # m above the highest ground under a bush
WAVER = 0.3  # m that bushes stand off the border
TREES = 0.3  # of the bushes have a tree in them
ROOT = 0.5  # m


def grow_thickets(borders: Sequence[Border], seed: int, terrain: Terrain) -> list[Solid]:
    """Return the bushes and trees on those borders that are thickets."""
    solids = []
    for number, border in enumerate(borders):
        if border.barrier is not Barrier.THICKET:
            continue
        dice = Dice(seed, Stream.COUNTRY, agent=20_000 + number)
        for start, end in border.spans(GAP + 2.0 * RADIUS[0]):
            steps = max(1, int((end - start) / STEP + 0.999))
            for step in range(steps + 1):
                along = start + (end - start) * step / steps
                x, z = border.at(along, dice.uniform(-WAVER, WAVER))
                # Bushes at a gap are of the least size, so that all gaps are passable.
                is_last = border.gate is not None and abs(along - border.gate) < GAP / 2.0 + 3.0
                solids += _bush(dice, x, z, terrain, narrow=is_last)
    return solids


def _bush(dice: Dice, x: float, z: float, terrain: Terrain, *, narrow: bool) -> list[Solid]:
    """Return a bush, perhaps with a conifer that rises from it."""
    radius = RADIUS[0] if narrow else dice.uniform(*RADIUS)
    grounds = [
        height_at(terrain.corner, terrain.heights, x + east, z + north)
        for east, north in ((0.0, 0.0), (radius, 0.0), (-radius, 0.0), (0.0, radius), (0.0, -radius))
    ]
    low, top = min(grounds) - ROOT, max(grounds) + dice.uniform(*HEIGHT)
    outline = polygon(7, dice.uniform(0.0, 360.0))
    middle = 0.5 * (max(grounds) + top)
    rings = ((low, radius * 0.9), (middle, radius), (top - 0.3, radius * 0.8), (top, radius * 0.55))
    solids = [stack(Kind.BUSH, x, z, outline, rings)]
    if dice.uniform() < TREES:
        crown, rise = dice.uniform(1.2, 1.9), dice.uniform(4.0, 7.5)
        solids.append(stack(Kind.TRUNK, x, z, polygon(6, 0.0), ((low, 0.3), (top + 0.6, 0.25))))
        cone = ((top + 0.4, crown * 0.5), (top + 1.2, crown), (top + rise, 0.0))
        solids.append(stack(Kind.CROWN, x, z, outline, cone))
    return solids
