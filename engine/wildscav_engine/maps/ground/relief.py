"""Relief: the plains, hills, mountain chains and cliffs of a map, and their heights."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream, uniform
from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.specs.map_spec import MapConfig

STREAM = int(Stream.TERRAIN)
GRADIENTS_KEY = 1  # the frame that keys the noise
LATTICE = 128  # points along a side of the noise's lattice, its period; a power of two
SPREAD = 1.5  # scales one octave of noise mostly to the range from -1 to 1
SHORTEST_LANDFORM, LONGEST_LANDFORM = 40.0, 540.0  # m from one upland to the next, by the size of the map
STEEPNESS = 0.12  # m of height per m from one upland to the next, at relief 1
STEEPNESS_OF_SMALL = 2.2  # m of additional height, which matters on small maps
LEAST_RANGE = 0.65  # of the landform's height, least difference between a map's highest and lowest ground
SHORE_WAVE, SHORE_HEIGHT = 26.0, 0.5  # m, of the bumps that bend the shores of lakes, at relief 1
FINEST_HILLS = 11.0  # m, the shortest waves
HILL_OCTAVES = 4
CLIFF_WIDTH = 0.45  # m on either side of a cliff's middle within which it rises, per m of its height
WIDEST_CLIFF = 2.2  # m

# The layers of noise; each has its own origin in the lattice.
WARP_EAST, WARP_NORTH, UPLANDS, CHAINS, HILLS, DETAIL, MOUNTAINOUS, PLAIN, CLIFFY, BREAKS, SHORES = range(11)
LAYERS = 11


class Landform(NamedTuple):
    """The parameters of a map's relief."""

    wave: float  # m from one upland to the next
    height: float  # m, approximate height of the uplands over the hollows
    step: float  # m, height of cliffs
    east: float  # direction of the chains: sine and cosine of a yaw
    north: float
    stretch: float  # length of chains per distance between them
    mountains: float  # from about -1, mountains everywhere, to 1, none
    plains: float
    cliffs: float


def draw_landform(config: MapConfig, relief: float, seed: int) -> Landform:
    """Draw the parameters of a map's relief."""
    dice = RandomStream(seed, Stream.TERRAIN, agent=1)
    wave = min(max(SHORTEST_LANDFORM, 0.75 * config.size), LONGEST_LANDFORM) * dice.uniform(0.8, 1.2)
    height = relief * (STEEPNESS * wave + STEEPNESS_OF_SMALL) * dice.uniform(0.85, 1.15)
    yaw = dice.uniform(-180.0, 180.0)
    rugged = config.ruggedness
    return Landform(
        wave=wave,
        height=height,
        step=min(max(2.6, 0.2 * height), 9.0) * dice.uniform(0.85, 1.15),
        east=sine(yaw),
        north=cosine(yaw),
        stretch=dice.uniform(1.0, 2.4),
        mountains=0.55 - 0.9 * rugged + dice.uniform(-0.25, 0.25),
        plains=-0.5 + 1.0 * rugged + dice.uniform(-0.25, 0.25),
        cliffs=0.75 - 1.05 * rugged + dice.uniform(-0.15, 0.15),
    )


@array_kernel
def _draw_gradients(seed: np.uint64) -> NDArray[np.float64]:
    gradients = np.empty((LATTICE, LATTICE, 2))
    for row in range(LATTICE):
        for column in range(LATTICE):
            turn = 360.0 * uniform(seed, STREAM, GRADIENTS_KEY, row, column)
            gradients[row, column, 0] = cosine(turn)
            gradients[row, column, 1] = sine(turn)
    return gradients


class Noise(NamedTuple):
    """The noise that a map's relief is made of."""

    gradients: NDArray[np.float64]  # (LATTICE, LATTICE, 2) unit vectors in random directions
    origins: NDArray[np.float64]  # (LAYERS, 2) of each layer in the lattice


def draw_noise(seed: int) -> Noise:
    """Draw the noise of a map."""
    dice = RandomStream(seed, Stream.TERRAIN, agent=2)
    origins = np.array([[dice.uniform(0.0, LATTICE) for _ in range(2)] for _ in range(LAYERS)])
    return Noise(_draw_gradients(np.uint64(seed)), origins)


@kernel
def _noise(gradients: NDArray[np.float64], x: float, z: float) -> float:
    """Return gradient noise (Perlin, "Improving Noise", SIGGRAPH 2002), mostly from -1 to 1."""
    west, south = np.floor(x), np.floor(z)
    east, north = x - west, z - south
    blend_x = east * east * east * (east * (east * 6.0 - 15.0) + 10.0)
    blend_z = north * north * north * (north * (north * 6.0 - 15.0) + 10.0)
    c0, r0 = int(west) & (LATTICE - 1), int(south) & (LATTICE - 1)
    c1, r1 = (c0 + 1) & (LATTICE - 1), (r0 + 1) & (LATTICE - 1)
    h00 = gradients[r0, c0, 0] * east + gradients[r0, c0, 1] * north
    h01 = gradients[r0, c1, 0] * (east - 1.0) + gradients[r0, c1, 1] * north
    h10 = gradients[r1, c0, 0] * east + gradients[r1, c0, 1] * (north - 1.0)
    h11 = gradients[r1, c1, 0] * (east - 1.0) + gradients[r1, c1, 1] * (north - 1.0)
    at_south, at_north = h00 + blend_x * (h01 - h00), h10 + blend_x * (h11 - h10)
    return float(SPREAD * (at_south + blend_z * (at_north - at_south)))


@kernel
def _layer(noise: Noise, layer: int, octaves: int, gain: float, x: float, z: float) -> float:
    """Return a sum of octaves of noise, each with half the wavelength and ``gain`` times the height."""
    gradients, origins = noise
    x, z = x + origins[layer, 0], z + origins[layer, 1]
    total, height = 0.0, 1.0
    for _ in range(octaves):
        total += height * _noise(gradients, x, z)
        x, z = 1.6 * x - 1.2 * z, 1.2 * x + 1.6 * z
        height *= gain
    return total


@kernel
def _crests(noise: Noise, x: float, z: float) -> float:
    """Return ridged noise, 0 to about 1 along crests; only the crests branch into finer ones.

    Musgrave, in Ebert et al., "Texturing and Modeling: A Procedural Approach", 3rd ed., chapter 16.
    """
    gradients, origins = noise
    x, z = x + origins[CHAINS, 0], z + origins[CHAINS, 1]
    total, height, weight = 0.0, 0.62, 1.0
    for _ in range(4):
        # The square root rounds the crest, so that it can be walked along.
        away = _noise(gradients, x, z)
        crest = max(0.0, 1.0 - np.sqrt(away * away + 0.004) * 1.15)
        crest = crest * crest * weight
        total += height * crest
        weight = min(1.0, 1.7 * crest)
        x, z = 1.6 * x - 1.2 * z, 1.2 * x + 1.6 * z
        height *= 0.45
    return total


@kernel
def smooth_step(low: float, high: float, value: float) -> float:
    """Return 0 below ``low``, 1 above ``high``, and a smooth transition between."""
    share = min(max((value - low) / (high - low), 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


@kernel
def compose_land(
    landform: Landform,
    noise: Noise,
    broad: NDArray[np.float64],
    hills: NDArray[np.float64],
    cliffs: NDArray[np.float64],
) -> None:
    """Compose the land from noise of low and high frequency.

    It writes the uplands and mountain chains, (R, C) m; the hills to be added to them, (R, C) m; and how much
    slopes are gathered into cliffs, (R, C) from 0 to 1.
    """
    octaves = 1
    while octaves < HILL_OCTAVES + 3 and 0.4 * landform.wave / 2.0**octaves >= FINEST_HILLS:
        octaves += 1
    for row in range(broad.shape[0]):
        for column in range(broad.shape[1]):
            x, z = column * CELL / landform.wave, row * CELL / landform.wave
            warp_x = 0.3 * _layer(noise, WARP_EAST, 2, 0.5, 1.3 * x, 1.3 * z)
            warp_z = 0.3 * _layer(noise, WARP_NORTH, 2, 0.5, 1.3 * x, 1.3 * z)
            plain = _layer(noise, PLAIN, 1, 0.5, 0.8 * x + warp_x, 0.8 * z + warp_z)
            plain = smooth_step(landform.plains - 0.3, landform.plains + 0.3, plain)
            rocky = _layer(noise, CLIFFY, 1, 0.5, x + warp_x, z + warp_z)
            gap = _layer(noise, BREAKS, 1, 0.5, CELL * column / 46.0, CELL * row / 46.0)
            rocky = smooth_step(landform.cliffs - 0.2, landform.cliffs + 0.2, rocky)
            cliffs[row, column] = rocky * smooth_step(-0.3, 0.1, gap)
            mountain = _layer(noise, MOUNTAINOUS, 1, 0.5, 0.55 * x + warp_x, 0.55 * z + warp_z)
            mountain = smooth_step(landform.mountains - 0.45, landform.mountains + 0.45, mountain)
            x, z = x + warp_x, z + warp_z
            upland = _layer(noise, UPLANDS, 2, 0.4, x, z)
            along = (x * landform.east + z * landform.north) / landform.stretch
            across = x * landform.north - z * landform.east
            crest = _crests(noise, 0.9 * across, 0.9 * along)
            flat = 1.0 - 0.75 * plain * (1.0 - mountain)
            broad[row, column] = landform.height * (0.5 * upland * flat + 1.1 * mountain * crest)
            hill = _layer(noise, HILLS, octaves, 0.42, 2.5 * x, 2.5 * z)
            hills[row, column] = landform.height * hill * (0.04 + 0.18 * (1.0 - plain))


@kernel
def draw_bumps(relief: float, noise: Noise, bumps: NDArray[np.float64]) -> None:
    """Write (R, C) m, the bumps that bend the shores of lakes with flat banks."""
    for row in range(bumps.shape[0]):
        for column in range(bumps.shape[1]):
            x, z = column * CELL / SHORE_WAVE, row * CELL / SHORE_WAVE
            bumps[row, column] = SHORE_HEIGHT * relief * _layer(noise, SHORES, 2, 0.5, x, z)


@kernel
def raise_cliffs(
    step: float, broad: NDArray[np.float64], cliffs: NDArray[np.float64], heights: NDArray[np.float64]
) -> None:
    """Gather slopes into steps where the land is rocky; all steps are equally steep, ``step`` m high.

    Cliffs, (R, C) from 0 to 1, say how far the ground follows the terraces. It is written to ``heights``.
    """
    rows, columns = broad.shape
    width = min(CLIFF_WIDTH * step, WIDEST_CLIFF)
    for row in range(rows):
        south, north = max(0, row - 1), min(rows - 1, row + 1)
        for column in range(columns):
            west, east = max(0, column - 1), min(columns - 1, column + 1)
            up_east = (broad[row, east] - broad[row, west]) / ((east - west) * CELL)
            up_north = (broad[north, column] - broad[south, column]) / ((north - south) * CELL)
            slope = np.sqrt(up_east * up_east + up_north * up_north)
            level = np.floor(broad[row, column] / step)
            above = broad[row, column] - (level + 0.5) * step
            # How far in m the middle of the rise is away, on a slope as steep as here.
            away = above / max(slope, 0.03)
            rise = smooth_step(-width, width, away)
            terrace = (level + rise) * step + 0.25 * (above / step + 0.5 - rise) * step
            heights[row, column] = broad[row, column] + cliffs[row, column] * (terrace - broad[row, column])
