"""The home page: the README with a card of links for each kind of reader."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any


def with_readers(readme: str, nav: Sequence[Mapping[str, Any]]) -> str:
    """Return the README with a card for each part of the navigation, before its first section.

    Args:
        readme: The text.
        nav: The navigation from ``mkdocs.yml``.
    """
    opening, heading, rest = readme.partition("\n## ")
    cards = [
        f"-   **{title}**\n\n    {' · '.join(_links(pages))}\n"
        for part in nav
        for title, pages in part.items()
        if not isinstance(pages, str)
    ]
    return "\n".join([opening, '<div class="grid cards" markdown>\n', *cards, "</div>\n", heading + rest])


def _links(pages: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Return a link to each page of a part, and to the first page of each nested part."""
    for entry in pages:
        for title, target in entry.items():
            yield f"[{title}]({_first(target)})"


def _first(target: Any) -> str:
    """Return a page, or the first page of a part."""
    return target if isinstance(target, str) else _first(next(iter(target[0].values())))
