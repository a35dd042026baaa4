"""A picture of standings: ratings with intervals, bands, and the results of every two entrants."""

from collections.abc import Callable, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.storage.files import write_whole
from wildscav_evaluator.ratings.standings import Standing, Standings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_SHOWN = 50  # entrants; of more, the best are shown
MAX_WITH_NUMBERS = 25  # entrants, up to which the shares of points are written into the matrix
LONGEST_NAME, LONGEST_COLUMN = 32, 23  # characters of a name beside a row and above a column
DOTS_PER_INCH = 110
# Heights in inches: of the title, of a row, and of the margin below.
TITLE, ROW, MARGIN = 1.05, 0.3, 0.25
LETTER = 0.078  # inches, the width of most letters
# Widths in inches: of the ratings, of the numbers beside them, of a lane for bands, and of a matrix cell.
RATINGS, COLUMNS, LANE, CELL = 5.6, 2.5, 0.14, 0.36
# Colours for the bands in turn, which people with colour blindness can tell apart (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
GRID, TEXT, NEVER_MET = "#d8dee4", "#1c2733", "#c3cbd3"

BandLine = tuple[int, int, int, int]  # lane, first row, last row, and the index of the band


def draw_standings(standings: Standings, title: str, path: Path) -> Path:
    """Draw standings as a PNG, whole or not at all, and return its path; equal standings give equal files.

    The title is its first line, such as the track and the number of matches.
    """
    return draw_figure(lambda: _figure(standings, title), path)


def draw_figure(figure: "Callable[[], Figure]", path: Path) -> Path:
    """Draw a figure as a PNG, whole or not at all, and return its path."""
    from matplotlib import style

    content = BytesIO()
    # Not the settings of the user, so that the picture is the same everywhere.
    with style.context(["default", {"font.size": 9.0, "text.parse_math": False, "text.color": TEXT}]):
        figure().savefig(content, format="png", metadata={"Software": None})
    write_whole(path, content.getvalue())
    return path


def _figure(standings: Standings, title: str) -> "Figure":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = standings.standings[:MAX_SHOWN]
    lines = band_lines(standings.bands, [one.entrant for one in shown])
    names = 0.4 + LETTER * max(len(_label(one)) for one in shown)
    lanes = LANE * (1 + max((lane for lane, *_ in lines), default=0)) + 0.1
    widths = [names, lanes, RATINGS, COLUMNS, CELL * len(shown), MARGIN]
    width, rows = max(sum(widths), 11.0), ROW * len(shown)
    header = 0.2 + LETTER * max(len(_shortened(one.entrant, LONGEST_COLUMN)) for one in shown)
    height = TITLE + header + rows + MARGIN
    figure = Figure(figsize=(width, height), dpi=DOTS_PER_INCH, facecolor="white")
    FigureCanvasAgg(figure)
    for line, (text, size) in enumerate([(title, 13), *((text, 9) for text in _legend(standings))]):
        figure.text(0.2 / width, 1.0 - (0.35 + 0.27 * line) / height, text, fontsize=size)
    left = np.cumsum([0.0, *widths]) / width
    lanes_axes, ratings_axes, matrix_axes = (
        figure.add_axes((left[part], MARGIN / height, widths[part] / width, rows / height))
        for part in (1, 2, 4)
    )
    _draw_bands(lanes_axes, lines, shown)
    _draw_ratings(ratings_axes, shown)
    _draw_matrix(matrix_axes, standings, shown)
    return figure


def _legend(standings: Standings) -> tuple[str, str]:
    """Return two lines that explain the picture."""
    count, groups = len(standings.standings), max(one.group for one in standings.standings)
    parts = [f"the best {MAX_SHOWN} of {count:,} entrants" if count > MAX_SHOWN else f"{count} entrants"]
    if groups > 1:
        parts.append(f"{groups} groups that never met, so their ratings cannot be compared")
    parts.append("ranks that each may have; ratings with 95 % intervals")
    matrix = (
        "matrix: the percentage of points that the row's entrant won against the column's; grey: never met"
    )
    return " · ".join(parts), f"a bar joins entrants that cannot be told apart · {matrix}"


def _label(standing: Standing) -> str:
    return f"{_shortened(standing.entrant, LONGEST_NAME)}   {standing.ranks}"


def _shortened(name: str, longest: int) -> str:
    return name if len(name) <= longest else name[: longest - 1] + "…"


def band_lines(bands: Sequence[Sequence[str]], names: Sequence[str]) -> list[BandLine]:
    """Return where to draw the bands, from the best to the worst, in the rows of some names.

    Bands of one entrant, and those below the last row, are left out. Bands in one lane do not touch.
    """
    row = {name: index for index, name in enumerate(names)}
    placed, ends = [], list[int]()
    for index, band in enumerate(bands):
        rows = [row[name] for name in band if name in row]
        if len(band) < 2 or not rows:
            continue
        first, last = min(rows), max(rows)
        lane = next((lane for lane, end in enumerate(ends) if end < first), len(ends))
        ends[lane : lane + 1] = [last]
        placed.append((lane, first, last, index))
    return placed


def _colour(band: int) -> str:
    return COLOURS[band % len(COLOURS)]


def _clear(axes: "Axes", rows: int) -> None:
    axes.set_ylim(rows - 0.5, -0.5)
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0, colors=TEXT)


def _draw_bands(axes: "Axes", lines: list[BandLine], shown: Sequence[Standing]) -> None:
    _clear(axes, len(shown))
    most = 1 + max((lane for lane, *_ in lines), default=0)
    axes.set_xlim(most + 0.1, -0.6)  # the first lane beside the ratings
    axes.set_xticks([])
    axes.set_yticks(range(len(shown)), [_label(one) for one in shown])
    for lane, first, last, band in lines:
        axes.plot([lane, lane], [first - 0.3, last + 0.3], color=_colour(band), linewidth=3.5)


def _draw_ratings(axes: "Axes", shown: Sequence[Standing]) -> None:
    _clear(axes, len(shown))
    ratings = np.array([one.rating for one in shown])
    margin = max(60.0, 0.25 * float(np.ptp(ratings)))
    axes.set_xlim(ratings.min() - margin, ratings.max() + margin)  # very wide intervals are cut
    axes.set_yticks([])
    axes.xaxis.tick_top()
    axes.grid(axis="x", color=GRID)
    axes.set_axisbelow(True)
    for row, one in enumerate(shown):
        colour = _colour(one.bands[0] - 1)
        if one.low is not None and one.high is not None:
            axes.plot([one.low, one.high], [row, row], color=colour, linewidth=2.2, alpha=0.55)
        axes.plot([one.rating], [row], "o", color=colour, markersize=6)
        if row and one.group != shown[row - 1].group:
            axes.axhline(row - 0.5, color=TEXT, linewidth=0.8, linestyle=":")
    _write_columns(axes, shown)


def _write_columns(axes: "Axes", shown: Sequence[Standing]) -> None:
    """Write numbers beside the ratings."""
    columns = (
        ("rating", [f"{one.rating:.0f}" for one in shown]),
        ("wins", [one.first_places for one in shown]),
        ("matches", [f"{one.matches}" for one in shown]),
        ("mean place", [f"{one.mean_place:.2f}" for one in shown]),
    )
    ends = (0.55, 0.95, 1.5, 2.25)  # inches from the ratings
    for (title, values), end in zip(columns, ends, strict=True):
        x = 1.0 + end / RATINGS
        for row, value in [(-0.85, title), *enumerate(values)]:
            axes.text(
                x,
                row,
                value,
                transform=axes.get_yaxis_transform(),
                horizontalalignment="right",
                verticalalignment="center",
                color=TEXT,
                fontsize=8,
            )


def shares_of_points(standings: Standings, shown: Sequence[Standing]) -> NDArray[np.float64]:
    """Return the share of points of each entrant (rows) against each other one; NaN if they never met."""
    row = {one.entrant: index for index, one in enumerate(shown)}
    shares = np.full((len(shown), len(shown)), np.nan)
    for pair in standings.pairs:
        if pair.first in row and pair.second in row:
            first, second = row[pair.first], row[pair.second]
            share = (pair.wins + pair.ties / 2) / (pair.wins + pair.ties + pair.losses)
            shares[first, second], shares[second, first] = share, 1.0 - share
    return shares


def _draw_matrix(axes: "Axes", standings: Standings, shown: Sequence[Standing]) -> None:
    from matplotlib import colormaps

    shares = shares_of_points(standings, shown)
    axes.set_facecolor(NEVER_MET)
    axes.imshow(shares, cmap=colormaps["RdBu"], vmin=0.0, vmax=1.0, aspect="auto", interpolation="nearest")
    _clear(axes, len(shown))
    axes.set_yticks([])
    axes.xaxis.tick_top()
    names = [_shortened(one.entrant, LONGEST_COLUMN) for one in shown]
    axes.set_xticks(range(len(shown)), names, rotation=90, fontsize=8)
    if len(shown) > MAX_WITH_NUMBERS:
        return
    for row, column in np.argwhere(~np.isnan(shares)).tolist():
        share = shares[row, column]
        axes.text(
            column,
            row,
            f"{100 * share:.0f}",
            horizontalalignment="center",
            verticalalignment="center",
            fontsize=8,
            color="white" if abs(share - 0.5) > 0.35 else TEXT,
        )
