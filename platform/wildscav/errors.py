"""The errors that Wildscav raises for its users to read."""

from pathlib import Path

INTERRUPTED = 130  # exit code of a command that Ctrl-C ended, by the convention of shells


class WildscavError(Exception):
    """Base of all errors of Wildscav. The message is one clear line."""


class UserError(WildscavError):
    """What the user asked for cannot be done. The command prints the message and exits.

    Args:
        message: One line: what, where, and what to do about it.
        exit_code: 2 for a usage error (a wrong argument or file), 1 for a failure.
    """

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(message)
        self.exit_code = exit_code


class AgentError(WildscavError):
    """The agent's own code broke the rules of the SDK."""


class ServerUnreachableError(WildscavError):
    """No match server answers, or it closed the connection before the match was over."""


class RefusedError(WildscavError):
    """The match server refused the seat.

    Args:
        reason: The reason in the server's status, such as ``SEAT_TOKEN_UNKNOWN``.
    """

    def __init__(self, reason: str, message: str) -> None:
        super().__init__(f"{message} ({reason})" if reason else message)
        self.reason = reason


class AddressInUseError(WildscavError):
    """Another process listens on the address already, or the address cannot be bound."""

    def __init__(self, address: str, reason: str = "it is in use already") -> None:
        super().__init__(f"cannot listen on {address}: {reason}; choose another address")
        self.address = address


class SensorError(WildscavError, ValueError):
    """A seat asks for a sensor that does not exist, or gives it options that it does not take."""


def describe(error: BaseException) -> str:
    """Return one line that says what went wrong, and with which file, if the system names one."""
    reason = str(error) or type(error).__name__
    if not isinstance(error, OSError):
        return reason
    reason = error.strerror or reason
    return reason if error.filename is None else f"{Path(str(error.filename))}: {reason}"
