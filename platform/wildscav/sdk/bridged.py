"""Play one match by words or by keys, at a bridge."""

from collections.abc import Callable
from importlib import import_module

from wildscav.errors import AgentError, UserError
from wildscav.sdk.watchdog import end_watch

# By interface: the module, and its classes of a seat and of those who play it.
BRIDGED = {
    "words": ("wildscav.words", "WordsSeat", "WordsPlayer"),
    "keys": ("wildscav.keyboard", "KeysSeat", "KeysPlayer"),
}


def play_at_bridge(interface: str, factory: Callable[[], object], address: str, token: str) -> None:
    """Play one match by an interface.

    Raises:
        UserError: There is no such interface.
        AgentError: The player is none of the interface, or the bridge refuses a request.
        ServerUnreachableError: No bridge answers, or the connection was lost.
    """
    if interface not in BRIDGED:
        names = ", ".join(("numbers", *BRIDGED))
        raise UserError(f"there is no interface {interface!r}; the interfaces are {names}", exit_code=2)
    module_name, seat_name, player_name = BRIDGED[interface]
    module = import_module(module_name)
    player = factory()
    if not isinstance(player, getattr(module, player_name)):
        raise AgentError(
            f"{getattr(factory, '__name__', repr(factory))} must be a subclass of "
            f'{module_name}.{player_name}, because its submission.toml says interface = "{interface}"'
        )
    with getattr(module, seat_name)(address, token) as seat:
        end_watch()  # of the start
        player.play(seat)
