"""The page that explains an exported season to whoever finds it."""

from wildscav.terminal.console import counted
from wildscav_leaderboard.publishing.documents import PublishedSeason

TEXT = """# {title}

What is published of the season `{name}` ({opens:%Y-%m-%d} to {closes:%Y-%m-%d}), as files. {state}

`wildscav audit FOLDER` (or the address at which these files are served) checks all of it: it plays the
records again, and computes every score, interval and rating anew. `sha256sum --check SHA256SUMS` shows
whether a file was damaged on its way.

| file | |
|---|---|
| `season.json` | the season: its dates, its tracks, the commitments to its secrets{secret} |
| `boards/TRACK.json`, `boards/TRACK.csv` | the board of a track{season} |
| `tracks/TRACK.ndjson` | for audits: the board, its submissions, and the matches that count, one a line |
| `matches/TRACK.csv` | those matches for spreadsheets, a row for each seat |
| `records/…/MATCH.wsr` | a match: `wildscav verify` plays it again, `wildscav replay` shows it |
| `SHA256SUMS` | a digest of each file |

| track | ranked by | suite | rounds |
|---|---|---|---|
{tracks}

The secrets from which the seeds of all matches follow, and of those that decide the season, have the SHA-256

    {commitment}  secret.txt
    {final}  final-secret.txt

{boards}, {matches}, {records}{hidden}.
"""


def readme(season: PublishedSeason, boards: int, matches: int, records: int, hidden: int) -> str:
    """Return the page, in Markdown.

    Args:
        season: The season.
        boards: Their number.
        matches: Their number.
        records: Their number.
        hidden: The number of records that cannot be published yet.
    """
    tracks = [
        f"| {track.name} | {'a ladder' if track.mode == 'ladder' else 'the suite'} | `{track.suite}` "
        f"| {'' if track.mode == 'ladder' else track.rounds} |"
        for track in season.tracks
    ]
    return TEXT.format(
        title=_plain(season.title),
        name=season.name,
        opens=season.opens,
        closes=season.closes,
        state="It is final." if season.finalized else "The season is not finalized yet.",
        season="; `TRACK-season`: as it was before final matches decided it" if season.finalized else "",
        secret="" if season.secret.secret is None else ", and the secrets themselves",
        tracks="\n".join(tracks),
        commitment=season.secret.commitment,
        final=season.final_secret.commitment,
        boards=counted(boards, "board"),
        matches=counted(matches, "match"),
        records=counted(records, "record"),
        hidden=f"; {hidden:,} more are hidden until the secret is opened" if hidden else "",
    )


def _plain(text: str) -> str:
    """Return a text that Markdown shows as it is."""
    return "".join(f"\\{letter}" if letter in "\\`*_{}[]()#+-.!|<>" else letter for letter in text)
