"""A match in a notebook: its page is all that the cell needs."""

import re
from collections.abc import Callable
from html import unescape
from pathlib import Path

from wildscav_engine.record import read_record
from wildscav_stage.notebook import show
from wildscav_stage.watching.match_page import scene_of, whole_page


def test_a_cell_has_the_whole_page_which_cannot_reach_the_notebook(
    viewer: Path, record_of_track: Callable[[str], Path]
) -> None:
    record = record_of_track("battle")
    cell = show(record, height=300)._repr_html_()
    found = re.fullmatch(
        r'<iframe srcdoc="([^"]*)" sandbox="allow-scripts" allow="fullscreen" style="(.*)">.*', cell
    )
    assert found is not None
    assert unescape(found[1]) == whole_page(scene_of(record))
    assert "height: 300px" in found[2]
    assert show(read_record(record), height=300)._repr_html_() == cell
