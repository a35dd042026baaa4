"""Translation of the pages' links from paths in the repository to paths on the website."""

import posixpath
import re
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = "docs/"
EXAMPLES = "docs/examples/"  # whose programs are pages of the website
SOURCES = "source/"  # the website's folder for other files of the repository that pages link to
# Files of code from which pages of the website are made.
GENERATED = {
    "platform/wildscav/proto/match.proto": "reference/protocol.md",
    "platform/wildscav/agent.py": "reference/sdk.md",
    "platform/wildscav/skills/__init__.py": "reference/sdk.md",
    "platform/wildscav/cli/main.py": "reference/commands.md",
    "website/wildscav_website/references/modules.py": "reference/modules.md",
    "platform/wildscav/harness/settings.py": "reference/sdk.md",
    "platform/wildscav_language/calls.py": "reference/tools.md",
    "platform/wildscav_language/tools/__init__.py": "reference/tools.md",
    "platform/wildscav_server/server_metrics.py": "reference/metrics.md",
    "evaluator/wildscav_evaluator/ledger/entries.py": "reference/files.md",
    "evaluator/wildscav_evaluator/model_gateway/settings.py": "reference/files.md",
    "evaluator/wildscav_evaluator/monitoring/monitor.py": "reference/metrics.md",
    "evaluator/wildscav_evaluator/output/results.py": "reference/files.md",
    "evaluator/wildscav_evaluator/tournaments/tournament_file.py": "reference/files.md",
    "leaderboard/wildscav_leaderboard/hosting/metrics.py": "reference/metrics.md",
    "engine/wildscav_engine/envs/settings/config.py": "environments/navigation.md",
    "engine/wildscav_engine/envs/league/league.py": "reference/environments.md",
    "engine/wildscav_engine/envs/settings/functions.py": "reference/environments.md",
    "engine/wildscav_engine/envs/settings/players.py": "reference/environments.md",
    "engine/wildscav_engine/specs/map_spec.py": "reference/matches.md",
    "engine/wildscav_engine/sensors/__init__.py": "reference/every-sensor.md",
}
# Files outside docs/ that are pages of the website as they are.
COPIED = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "LICENSE": "license.md",
    "CODE_OF_CONDUCT.md": "code-of-conduct.md",
    "SECURITY.md": "reporting.md",
    "benchmarks/results/baselines.md": "figures/baselines.md",
    "benchmarks/results/learning.md": "figures/learning.md",
    "benchmarks/results/sensors.md": "figures/sensors.md",
}
MOVED = {**COPIED, **GENERATED}
LINK = re.compile(r"(?<=\]\()(?![a-z]+:|#|/)([^)#\s]+)")


def page_of_example(source: str) -> str:
    """Return where the website shows a program of the examples."""
    return source.removeprefix(DOCS).removesuffix(".py") + ".md"


def links_for_site(markdown: str, page: str, add: Callable[[str], None]) -> str:
    """Return the text of a page with links that work on the website.

    Args:
        markdown: The text, with links that work in the repository.
        page: Its path on the website.
        add: Called with every linked file that is not a page of the website.
    """
    source_of_page = next((source for source, moved in MOVED.items() if moved == page), DOCS + page)
    origin = posixpath.dirname(source_of_page)

    def moved(link: re.Match[str]) -> str:
        source = posixpath.normpath(posixpath.join(origin, link[1]))
        is_page_elsewhere = source.endswith(".md") and not (source in MOVED or source.startswith(DOCS))
        if is_page_elsewhere or not (ROOT / source).is_file():
            return link[1]  # MkDocs reports it as broken
        if source in MOVED:
            target = MOVED[source]
        elif source.startswith(DOCS):
            target = page_of_example(source) if source.endswith(".py") else source.removeprefix(DOCS)
        else:
            add(source)
            target = SOURCES + source
        return posixpath.relpath(target, posixpath.dirname(page) or ".")

    return LINK.sub(moved, markdown)
