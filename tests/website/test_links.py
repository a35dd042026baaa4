"""Links between files of the repository work on the website, or are left for MkDocs to report."""

import pytest

from wildscav_website.links import links_for_site


@pytest.mark.parametrize(
    ("link", "moved", "added"),
    [
        ("rules.md#spl", "rules.md#spl", []),
        ("#e", "#e", []),
        ("https://example.org/x.md", "https://example.org/x.md", []),
        ("../README.md#install", "index.md#install", []),
        ("../CONTRIBUTING.md", "contributing.md", []),
        ("examples/self_play.py", "examples/self_play.md", []),
        ("examples/demo_season.json", "examples/demo_season.json", []),
        ("../Makefile", "source/Makefile", ["Makefile"]),
        # A page that the website does not have would be a broken link there, too.
        ("../submissions/learned-commando/README.md", "../submissions/learned-commando/README.md", []),
        ("missing.md", "missing.md", []),
    ],
)
def test_a_link_of_a_page(link: str, moved: str, added: list[str]) -> None:
    found: list[str] = []
    assert links_for_site(f"[text]({link})", "baselines.md", found.append) == f"[text]({moved})"
    assert found == added


def test_links_of_the_home_page() -> None:
    page = links_for_site("[a](docs/rules.md) [b](LICENSE)", "index.md", lambda _: None)
    assert page == "[a](rules.md) [b](license.md)"
