"""Parts of pages that are kept: made once, and forgotten when others were used more recently."""

from markupsafe import Markup

from wildscav_leaderboard.web.rendering import PageParts


def test_a_part_is_made_once_for_each_key() -> None:
    parts, made = PageParts(), []

    def make(key: str) -> Markup:
        made.append(key)
        return Markup("<b>%s</b>") % key

    shown = [parts.get(key, lambda key=key: make(key)) for key in ("a", "b", "a", "<c>", "a")]

    assert made == ["a", "b", "<c>"]
    assert shown == ["<b>a</b>", "<b>b</b>", "<b>a</b>", "<b>&lt;c&gt;</b>", "<b>a</b>"]


def test_what_was_not_used_for_the_longest_time_is_forgotten_first() -> None:
    parts, made = PageParts(most=2), []

    def ask(key: str) -> None:
        parts.get(key, lambda: made.append(key) or Markup("x"))

    for key in ("a", "b", "a", "c", "a", "b"):
        ask(key)

    assert made == ["a", "b", "c", "b"]
