"""Recorded matches in a notebook."""

from html import escape
from pathlib import Path

from wildscav_engine.record import Record, read_record
from wildscav_stage.watching.match_page import scene_of_record, whole_page

HEIGHT = 640  # pixels


class ShownMatch:
    """A match that Jupyter shows in 3D where it is the value of a cell, and in saved notebooks, too.

    Raises:
        RecordError: The record cannot be read, or not be played again.
        UserError: The viewer is not built.
    """

    def __init__(self, record: Record | Path | str, height: int = HEIGHT) -> None:
        self._height = height
        played = record if isinstance(record, Record) else read_record(Path(record))
        self._page = whole_page(scene_of_record(played))

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self._height}px; border: 0"
        page = escape(self._page)
        return f'<iframe srcdoc="{page}" sandbox="allow-scripts" allow="fullscreen" style="{style}"></iframe>'


def show(record: Record | Path | str, height: int = HEIGHT) -> ShownMatch:
    """Return a match for a notebook to show in 3D; see ``ShownMatch``."""
    return ShownMatch(record, height)
