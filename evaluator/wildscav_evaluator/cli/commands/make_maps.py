"""The command ``wildscav map make``."""

from typing import TYPE_CHECKING, Annotated, Literal, cast

import typer

from wildscav.cli.shared_options import AsJson, named_in
from wildscav.errors import UserError
from wildscav_evaluator.cli.options.evaluation import SecretOption, SeedOption
from wildscav_evaluator.cli.options.running import AddressOption, ExecutorOption, executor_of
from wildscav_training.cli.track_and_level import level_names

if TYPE_CHECKING:
    from wildscav_engine.maps.levels import Level


def make_maps(
    level: Annotated[
        str | None,
        typer.Option(
            help="Make a pool of maps of this level for environments.",
            show_default=False,
            **named_in(level_names),
        ),
    ] = None,
    count: Annotated[
        int | None,
        typer.Option(help="Maps of the pool. Default: 64.", min=1, max=1_000_000, show_default=False),
    ] = None,
    split: Annotated[
        Literal["train", "test"] | None,
        typer.Option(help="What the pool is for. Default: train.", show_default=False),
    ] = None,
    unseen: Annotated[
        bool, typer.Option("--unseen", help="Those for testing have houses and towns that others lack.")
    ] = False,
    suite: Annotated[
        str | None,
        typer.Option(help="Make the maps of this suite instead: its name or its file.", show_default=False),
    ] = None,
    track: Annotated[
        list[str] | None,
        typer.Option(help="Only those of this track of the suite; may be repeated.", show_default=False),
    ] = None,
    seed: SeedOption = None,
    secret: SecretOption = None,
    workers: Annotated[
        int | None,
        typer.Option(help="Maps at once. Default: one per processor core.", min=1, show_default=False),
    ] = None,
    executor: ExecutorOption = "local",
    address: AddressOption = None,
    as_json: AsJson = False,
) -> None:
    """Make many maps at once and cache them on this machine, so that training or an evaluation need not wait.

    Maps that are cached already are not made again.

    With --json: `made`, `cached` before, `bytes` and `folder` of the cache.
    """
    from wildscav_evaluator.cli.options.selection import check_suite_has, suite_seed
    from wildscav_evaluator.map_making import choices_of_pool, choices_of_suite, run_make_maps
    from wildscav_evaluator.suites.suite_file import find_suite

    if (level is None) == (suite is None):
        raise UserError("name either --level, for environments, or --suite, for evaluations", exit_code=2)
    of_pools = {"--count": count is not None, "--split": split is not None, "--unseen": unseen}
    for option, is_given in of_pools.items():
        if suite is not None and is_given:
            raise UserError(f"{option} is for pools (--level); a suite names its own maps", exit_code=2)
    if level is not None and track:
        raise UserError("--track is for suites (--suite); a pool serves all tracks", exit_code=2)
    first = suite_seed(seed, secret).value
    if level is not None:
        choices = choices_of_pool(cast("Level", level), split or "train", first, count or 64, unseen=unseen)
    else:
        chosen = find_suite(str(suite))
        for name in track or []:
            check_suite_has(chosen, name)
        choices = choices_of_suite(chosen, track or [], first)
    with executor_of(executor, address, workers) as machines:
        run_make_maps(choices, machines, as_json=as_json)
