"""Links between files of the repository work on the website, or are left for MkDocs to report."""

import pytest

from wildscav_website.links import links_for_site


@pytest.mark.parametrize(
    ("link", "moved", "added"),
    [
        ("rules.md#spl", "rules.md#spl", []),
        ("../CONTRIBUTING.md", "contributing.md", []),
        (
            "../submissions/homing/agent.py",
            "source/submissions/homing/agent.py",
            ["submissions/homing/agent.py"],
        ),
        # A page that the website does not have would be a broken link there, too.
        ("../submissions/learned-commando/README.md", "../submissions/learned-commando/README.md", []),
        ("missing.md", "missing.md", []),
    ],
)
def test_a_link_of_a_page(link: str, moved: str, added: list[str]) -> None:
    found: list[str] = []
    assert links_for_site(f"[text]({link})", "baselines.md", found.append) == f"[text]({moved})"
    assert found == added
