"""Drawing a map from above, on a sheet with title, coordinates, scale and legend."""

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL, Kind
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.picture.paint import CUT_WALL, DEEP, SHALLOW, STOREYS, contour_interval, raster
from wildscav_engine.maps.picture.top_view import Window, outlines
from wildscav_engine.maps.settlements.houses import House

if TYPE_CHECKING:
    from PIL.Image import Image

    from wildscav_engine.maps.picture.sheet import Entry, Layout

NARROWEST, WIDEST = 300, 8000  # pixels
SMALLEST_SPAN = 5.0  # m
INDOOR_DOT, OUTDOOR_DOT = (236, 32, 140), (255, 250, 235)
DOT_EDGE = (40, 30, 30)
DOT_RADIUS, SMALLEST_DOT, LARGEST_DOT = 0.35, 1.3, 6.0  # m; pixels


def draw_map(
    game_map: GameMap,
    *,
    width: int = 1200,
    storey: int | None = None,
    locations: bool = False,
    center: tuple[float, float] | None = None,
    span: float | None = None,
    title: str | None = None,
) -> "Image":
    """Return a picture of a map from above.

    Args:
        game_map: The map.
        width: Pixels, of the whole sheet.
        storey: The storey at which houses are cut open; 1 is the ground floor. None: houses show their roofs.
        locations: Whether to mark the valid locations; with a storey, those of other storeys and on roofs
            above it are left out.
        center: x and z in m of the picture's middle; None for the middle of the map.
        span: m, shown from west to east; None for the whole map.
        title: The title; None for the seed.

    Returns:
        The picture, in red, green and blue.

    Raises:
        MapError: An argument is outside its range.
    """
    from PIL import Image

    from wildscav_engine.maps.picture.sheet import lay_out, print_sheet

    _check(game_map, width, storey, center, span)
    rows, columns = game_map.world.water.shape
    layout = lay_out(width, rows / columns if center is None and span is None else 1.0)
    window = _window(game_map, layout, center, span)
    picture = Image.fromarray(raster(game_map, window, storey))
    if locations:
        _mark(picture, window, _shown_indoor(game_map, storey), INDOOR_DOT)
        _mark(picture, window, _shown_outdoor(game_map, storey), OUTDOOR_DOT)
    legend = _legend(game_map, storey, locations)
    return print_sheet(
        picture, layout, window, title or f"Seed {game_map.spec.seed}", _note(game_map), legend
    )


def _check(
    game_map: GameMap, width: int, storey: int | None, center: tuple[float, float] | None, span: float | None
) -> None:
    highest = max((house.storeys for house in game_map.houses), default=0)
    if not NARROWEST <= width <= WIDEST:
        raise MapError(f"width is {width}, must be {NARROWEST} to {WIDEST} pixels")
    if storey is not None and not 1 <= storey <= highest:
        allowed = f"must be 1 to {highest}" if highest else "but this map has no houses"
        raise MapError(f"storey is {storey}, {allowed}")
    half = game_map.config.size / 2
    if center is not None and not all(abs(place) <= half for place in center):
        raise MapError(f"center is {center}, must be within {-half:g} to {half:g} m")
    if span is not None and not SMALLEST_SPAN <= span <= 2 * game_map.config.size:
        raise MapError(f"span is {span}, must be {SMALLEST_SPAN:g} to {2 * game_map.config.size} m")


def _window(
    game_map: GameMap, layout: "Layout", center: tuple[float, float] | None, span: float | None
) -> Window:
    corner = game_map.world.corner
    rows, columns = game_map.world.water.shape
    x, z = center or (corner[0] + columns * CELL / 2, corner[1] + rows * CELL / 2)
    step = (span or columns * CELL) / layout.columns
    west, north = float(x - step * layout.columns / 2), float(z + step * layout.rows / 2)
    return Window(west, north, float(step), layout.rows, layout.columns)


def _shown_indoor(game_map: GameMap, storey: int | None) -> NDArray[np.float64]:
    """Return the indoor locations of a storey, (N, 3) m; all of them for None."""
    if storey is None:
        return game_map.indoor
    shown = np.zeros(len(game_map.indoor), np.bool_)
    for house in game_map.houses:
        level = (game_map.indoor[:, 1] - house.ground) / house.storey_height
        shown |= _over(house, game_map.indoor) & (np.floor(level + 0.5) == storey - 1)
    return game_map.indoor[shown]


def _shown_outdoor(game_map: GameMap, storey: int | None) -> NDArray[np.float64]:
    """Return the outdoor locations, (N, 3) m, without those on roofs that a cut at a storey removes."""
    if storey is None:
        return game_map.outdoor
    shown = np.ones(len(game_map.outdoor), np.bool_)
    for house in game_map.houses:
        if house.storeys >= storey:
            level = (game_map.outdoor[:, 1] - house.ground) / house.storey_height
            shown &= ~(_over(house, game_map.outdoor) & (np.floor(level + 0.5) >= storey))
    return game_map.outdoor[shown]


def _over(house: House, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (N,) whether places, (N, 3) m, lie within a house's outline."""
    across, along = house.pose.inside(places[:, 0], places[:, 2])
    return np.asarray(np.any([outline.holds(across, along) for outline in outlines(house)], axis=0))


def _mark(picture: "Image", window: Window, places: NDArray[np.float64], color: tuple[int, int, int]) -> None:
    """Draw a dot at each place, enlarged and scaled down for smooth edges."""
    from PIL import Image, ImageDraw

    radius = min(LARGEST_DOT, max(SMALLEST_DOT, DOT_RADIUS / window.step))
    larger = 4
    size = larger * (2 * int(radius + 2) + 1)
    dot = Image.new("RGBA", (size, size), (*DOT_EDGE, 0))
    draw = ImageDraw.Draw(dot)
    for color_here, grown in (((*DOT_EDGE, 230), max(0.6, 0.22 * radius)), ((*color, 255), 0.0)):
        reach = larger * (radius + grown)
        draw.ellipse((size / 2 - reach, size / 2 - reach, size / 2 + reach, size / 2 + reach), color_here)
    small = dot.resize((size // larger, size // larger), Image.Resampling.BOX)
    for x, _, z in places:
        column, row = (x - window.west) / window.step, (window.north - z) / window.step
        picture.paste(small, (int(column) - small.width // 2, int(row) - small.height // 2), small)


def _note(game_map: GameMap) -> str:
    rows, columns = game_map.world.water.shape
    houses = len(game_map.houses)
    return f"{columns * CELL:g} by {rows * CELL:g} m · {houses} {'house' if houses == 1 else 'houses'}"


def _legend(game_map: GameMap, storey: int | None, locations: bool) -> "list[Entry]":
    """Return the entries of the legend for this picture."""
    from wildscav_engine.maps.picture.sheet import Entry, metres

    entries = []
    for storeys, houses in sorted(Counter(house.storeys for house in game_map.houses).items()):
        color, word = _color(STOREYS[min(storeys, 4) - 1]), "storey" if storeys == 1 else "storeys"
        entries.append(Entry(f"{storeys} {word}: {houses}", color, "house"))
    if storey is not None:
        entries.append(Entry(f"wall, cut at storey {storey}", CUT_WALL, "house"))
    world = game_map.world
    if (world.water > world.heights[:-1, :-1]).any():
        entries.append(Entry("water", _color(0.6 * SHALLOW + 0.4 * DEEP), "patch"))
    for kind, text, tint in (
        (Kind.CROWN, "tree", (66, 132, 62)),
        (Kind.BUSH, "bush", (112, 150, 74)),
        (Kind.ROCK, "rock", (140, 138, 134)),
    ):
        if (world.solid_kind == kind).any():
            entries.append(Entry(text, tint, "round"))
    if locations:
        entries.append(Entry("indoor location", INDOOR_DOT, "dot"))
        entries.append(Entry("outdoor location", OUTDOOR_DOT, "dot"))
    interval = contour_interval(float(world.heights.max() - world.heights.min()))
    entries.append(Entry(f"contours every {metres(interval)}", (122, 84, 46), "line"))
    return entries


def _color(color: NDArray[np.float32]) -> tuple[int, int, int]:
    red, green, blue = (round(float(part)) for part in color)
    return red, green, blue
