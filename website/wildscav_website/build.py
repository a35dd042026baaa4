"""Additions to the build steps of MkDocs: pages generated from the code, and links that lead out of docs/."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files, InclusionLevel
from mkdocs.structure.pages import Page

from wildscav_website import demo_season, environments, home
from wildscav_website.links import COPIED, EXAMPLES, ROOT, SOURCES, links_for_site, page_of_example
from wildscav_website.references import (
    commands,
    legacy,
    metrics,
    modules,
    output_files,
    protocol,
    python_reference,
    rest,
    sdk,
    sensors,
    tools,
)

ASSETS = Path(__file__).parents[1] / "assets"


def generated_pages() -> dict[str, Callable[[], str]]:
    """Return a function for each page that is not in docs/, which writes it, by its path on the website."""
    copied = {moved: (ROOT / source).read_text for source, moved in COPIED.items()}
    return {
        **copied,
        **environments.pages(),
        **python_reference.pages(),
        "demo-season.md": demo_season.page,
        "reference/commands.md": commands.page,
        "reference/modules.md": modules.page,
        "reference/files.md": output_files.page,
        "reference/metrics.md": metrics.page,
        "reference/protocol.md": protocol.page,
        "reference/rest.md": rest.page,
        "reference/sdk.md": sdk.page,
        "reference/tools.md": tools.page,
        "reference/every-sensor.md": sensors.page,
    }


def examples() -> dict[str, Callable[[], str]]:
    """Return a function for each program of the examples, as ``generated_pages`` does."""
    programs = sorted((ROOT / EXAMPLES).rglob("[!_]*.py"))
    return {page_of_example(one.relative_to(ROOT).as_posix()): partial(_program, one) for one in programs}


def _program(path: Path) -> str:
    name = path.relative_to(ROOT).as_posix()
    return f"# `{path.name}`\n\n`{name}`:\n\n```python\n{path.read_text('utf-8')}```\n"


def on_files(files: Files, /, *, config: MkDocsConfig) -> Files:
    """Add the pages that are not in docs/, the style sheet, and the match of the home page."""
    for path, write in generated_pages().items():
        files.append(File.generated(config, path, content=write()))
    for path, write in examples().items():
        files.append(File.generated(config, path, content=write(), inclusion=InclusionLevel.NOT_IN_NAV))
    for asset in sorted(ASSETS.iterdir()):
        files.append(File.generated(config, f"assets/{asset.name}", abs_src_path=str(asset)))
    files.append(File.generated(config, home.MATCH, content=home.match_page()))
    return files


def on_page_markdown(markdown: str, /, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Make the links of a page work on the website, and add those that only the website has."""
    path = page.file.src_uri

    def add(source: str) -> None:
        if files.get_file_from_path(SOURCES + source) is None:
            included, place = InclusionLevel.INCLUDED, str(ROOT / source)
            files.append(File.generated(config, SOURCES + source, abs_src_path=place, inclusion=included))

    if page.file.generated_by is None or path in COPIED.values():
        markdown = links_for_site(markdown, path, add)
    if path == "index.md":
        page.meta["hide"] = ["navigation"]
        return home.with_readers(markdown, config.nav or [])
    if path == "legacy.md":
        return legacy.with_fields(markdown)
    return environments.link_to_pages(markdown) if path == "environments.md" else markdown
