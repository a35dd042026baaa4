"""Pages with a recorded match in 3D: on a site, or as one file that plays anywhere."""

import base64
import hashlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from html import escape
from pathlib import Path
from string import Template
from typing import NamedTuple

from wildscav.errors import UserError
from wildscav.notes import Note
from wildscav_engine.maps import MapError, map_of
from wildscav_engine.record import Record, RecordError, read_record
from wildscav_engine.tracks import TRACKS
from wildscav_stage.scene.map_file import map_file
from wildscav_stage.scene.notes import notes_beside, shown_notes
from wildscav_stage.scene.trails import trails_of
from wildscav_stage.viewer_files import LICENSES, SCRIPT, STYLE, viewer_addresses, viewer_file

STATIC = Path(__file__).parents[1] / "static"
PAGE_STYLE = "match.css"
NAMED = 4  # seats in a title
NO_SCRIPT = "<noscript><p>The match needs JavaScript.</p></noscript>"


FILES = ("map", "trails", "notes")  # of a scene, as pages and sites call them


class Scene(NamedTuple):
    """What the viewer draws a match from."""

    title: str
    map: bytes  # compressed, as ``scene/map_file.py`` tells
    trails: bytes  # compressed, as ``scene/document.py`` tells
    notes: bytes  # compressed, as ``scene/notes.py`` tells


def scene_of(path: Path, logs: Path | None = None) -> Scene:
    """Return what the record in a file is drawn from; for its agents' logs, see ``notes_beside``.

    Raises:
        UserError: It cannot be read, or not be played again.
    """
    with _errors_about(path):
        record = read_record(path)
        return scene_of_record(record, notes_beside(path, record, logs))


def title_of(path: Path) -> str:
    """Return the title of the record in a file, which is not played again.

    Raises:
        UserError: It cannot be read.
    """
    with _errors_about(path):
        return _title(read_record(path))


@contextmanager
def _errors_about(path: Path) -> Iterator[None]:
    try:
        yield
    except (RecordError, MapError) as error:
        message = str(error)
        raise UserError(message if str(path) in message else f"{path}: {message}") from None


def scene_of_record(record: Record, notes: Iterable[Note] = ()) -> Scene:
    """Return what a record is drawn from, with notes of its agents.

    Raises:
        RecordError: It cannot be played again.
        MapError: Its map cannot be made.
    """
    trails = trails_of(record)
    shown = shown_notes(notes, record.spec.frames_per_action)
    return Scene(_title(record), map_file(map_of(record.spec.map)), trails.compressed(), shown.compressed())


def _title(record: Record) -> str:
    """Return the track, the first names, and how many others there are."""
    names, others = record.names, len(record.names) - NAMED
    some = ", ".join(names) if others <= 1 else f"{', '.join(names[:NAMED])} and {others} others"
    return f"{TRACKS[record.spec.track].title}: {some}"


class Shown(NamedTuple):
    """A match on a site."""

    title: str
    address: str  # below it are the ``map``, the ``trails`` and the ``notes``


def match_page(match: Shown, other: Shown | None = None, root: str = "/") -> str:
    """Return the page of a match on a site that has the viewer's files below a root, or of two side by side.

    Raises:
        UserError: The viewer is not built.
    """
    script, style = viewer_addresses(root)
    head = f'<link rel="stylesheet" href="{style}"><script type="module" src="{script}"></script>'
    if other is None:
        return _page(match.title, f"{_linked_style(root)}{head}", f"{_element(match)}{NO_SCRIPT}")
    one, two = (
        _element(each, f' data-title="{escape(each.title)}"{more}')
        for each, more in ((match, ""), (other, " data-with"))
    )
    content = f'<div class="player-pair">{one}{two}</div>{NO_SCRIPT}'
    return _page("Two matches", f"{_linked_style(root)}{head}", content)


def _element(match: Shown, more: str = "") -> str:
    """Return what the viewer fills with a match; more: its further attributes."""
    data = " ".join(f'data-{name}="{match.address}/{name}"' for name in FILES)
    return f"<div data-match {data}{more}></div>"


def list_page(title: str, links: Iterable[tuple[str, str]]) -> str:
    """Return the page with a list of matches: the name and the address of each."""
    items = (f'<li><a href="{address}">{escape(name)}</a></li>' for name, address in links)
    return _page(title, _linked_style(), f"<ul>{''.join(items)}</ul>")


def text_page(title: str, text: str) -> str:
    """Return a page that says something."""
    return _page(title, _linked_style(), f"<p>{escape(text)}</p>")


def whole_page(scene: Scene) -> str:
    """Return the page of a match with all that it needs in it, the licences of its code too, for a file.

    Raises:
        UserError: The viewer is not built.
    """
    script = _inside("script", viewer_file(SCRIPT).decode())
    style = _inside("style", (STATIC / PAGE_STYLE).read_text("utf-8") + viewer_file(STYLE).decode())
    data = "".join(
        f'<script type="application/octet-stream;base64" id="wildscav-{name}">'
        f"{base64.b64encode(content).decode()}</script>"
        for name, content in zip(FILES, scene[1:], strict=True)
    )
    policy = (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; "
        "img-src blob: data:; base-uri 'none'; form-action 'none'"
    )
    code = f'<script type="module">{script}</script>'
    content = f"<div data-match data-embedded></div>{NO_SCRIPT}{data}{code}"
    licenses = viewer_file(LICENSES).decode().replace("--", "- -")  # which would end the comment
    return _page(scene.title, f"<!--\n{licenses}\n--><style>{style}</style>", content, policy)


def _page(title: str, head: str, content: str, policy: str = "") -> str:
    """Return a page; its policy is in it if no server tells one."""
    told = f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n' if policy else ""
    page = Template((STATIC / "match.html").read_text("utf-8"))
    return page.substitute(title=escape(title), head=head, content=content, policy=told)


def _linked_style(root: str = "/") -> str:
    icon, style = f"{root}static/icon.svg", f"{root}static/{PAGE_STYLE}"
    return f'<link rel="icon" href="{icon}"><link rel="stylesheet" href="{style}">'


def _inside(element: str, code: str) -> str:
    """Return code that does not end the element that it is in; in a string, the backslash changes nothing."""
    return code.replace(f"</{element}", f"<\\/{element}").replace("<!--", "<\\!--")


def _hash(content: str) -> str:
    """Return the source of a policy that allows one text inside of a page."""
    return f"sha256-{base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()}"
