"""The home page, and the fields that the reference describes."""

from pathlib import Path

import griffe

from wildscav_website import demo_season
from wildscav_website.field_comments import FieldComments
from wildscav_website.home import MATCH, match_page, with_readers

NAV = [
    {"Home": "index.md"},
    {
        "Readers": [
            {"One": "one.md"},
            {"Several": [{"First": "several/first.md"}, {"Next": "several/next.md"}]},
        ]
    },
]


def test_a_card_leads_from_the_home_page_to_each_part_of_the_navigation() -> None:
    page = with_readers("# Title\n\nOpening.\n\n## Install\n\nText.\n", NAV)
    opening, _, rest = page.partition('<div class="grid cards" markdown>')
    assert opening.split() == ["#", "Title", "Opening."]
    assert "**Readers**\n\n    [One](one.md) · [Several](several/first.md)\n" in rest
    assert "Home" not in rest
    assert rest.rstrip().endswith("## Install\n\nText.")


def test_a_match_takes_the_place_of_the_first_picture() -> None:
    page = with_readers("# Title\n\n![One](one.png)\n\nOpening.\n\n## Install\n\n![Two](two.png)\n", NAV)
    assert "one.png" not in page
    assert f'src="{MATCH}"' in page.partition("Opening.")[0]
    assert "![Two](two.png)" in page


def test_the_match_is_one_page_that_asks_for_nothing_else(viewer: Path) -> None:
    page = match_page()
    assert "data-embedded" in page
    assert "src=" not in page


def test_the_comment_beside_a_field_describes_it(tmp_path: Path) -> None:
    (tmp_path / "fields.py").write_text(
        "class Body:\n"
        "    height: float  # m, from the soles\n"
        "    name: str = 'a # b'\n"
        "    many: list = [\n        1,  # first\n    ]  # all of them\n"
        "    quiet = []  # noqa: RUF012\n"
        '    told: int  # not this\n    """This."""\n',
        "utf-8",
    )
    extensions = griffe.load_extensions(FieldComments())
    body = griffe.load("fields", search_paths=[str(tmp_path)], extensions=extensions)["Body"]
    described = {name: one.docstring and one.docstring.value for name, one in body.attributes.items()}
    assert described == {
        "height": "m, from the soles",
        "name": None,
        "many": "all of them",
        "quiet": None,
        "told": "This.",
    }


def test_the_boards_of_the_demo_season_show_every_row() -> None:
    text = demo_season.page()
    for board in demo_season.boards():
        for row in board.rows:
            assert f"| {row.ranks} | {row.team_title or 'a robot'} | {row.name}" in text
