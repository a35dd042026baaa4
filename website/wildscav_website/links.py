"""Links of pages, from where they lead in the repository to where that is on the site."""

import posixpath
import re
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = "docs/"
SOURCES = "source/"  # where the site keeps other files of the repository that pages link to
# Files outside docs/ that are pages of the site.
MOVED = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "LICENSE": "license.md",
    "platform/wildscav/proto/match.proto": "reference/protocol.md",
}
LINK = re.compile(r"(?<=\]\()(?![a-z]+:|#|/)([^)#\s]+)")


def origin_of(page: str) -> str:
    """Return where in the repository the text of a page stands."""
    return next((source for source, moved in MOVED.items() if moved == page), DOCS + page)


def links_for_site(markdown: str, page: str, add: Callable[[str], None]) -> str:
    """Return the text of a page with links that hold on the site.

    Args:
        markdown: The text, with links that hold in the repository.
        page: Its path on the site.
        add: Called with every file that is linked to and is not on the site by itself.
    """
    origin = posixpath.dirname(origin_of(page))

    def moved(link: re.Match[str]) -> str:
        source = posixpath.normpath(posixpath.join(origin, link[1]))
        if not (ROOT / source).is_file():
            return link[1]  # MkDocs says that it leads nowhere
        if source in MOVED:
            target = MOVED[source]
        elif source.startswith(DOCS):
            target = source.removeprefix(DOCS)
        else:
            add(source)
            target = SOURCES + source
        return posixpath.relpath(target, posixpath.dirname(page) or ".")

    return LINK.sub(moved, markdown)
