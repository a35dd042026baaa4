"""What can go wrong between a client and a season, each in one line for its user."""

import ssl
from http import HTTPStatus

import httpx

from wildscav.errors import UserError


class AnswerError(UserError):
    """The season refused a request.

    Args:
        message: Why, in the season's words.
        status: The HTTP status.
    """

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status

    @property
    def is_passing(self) -> bool:
        """Whether the same request may succeed in a moment."""
        return self.status in (HTTPStatus.TOO_MANY_REQUESTS, HTTPStatus.SERVICE_UNAVAILABLE)


class UnreachableError(UserError):
    """No answer came from a season's address."""


class NoSeasonError(UserError):
    """What answers at an address is not a season."""


def explained(error: httpx.HTTPError, url: str) -> UserError:
    """Return an error of a connection in our words."""
    cause = _root(error)
    if isinstance(cause, ssl.SSLCertVerificationError):
        return UserError(
            f"the certificate of {url} is not trusted: {cause.verify_message}; if it is the organizers' own, "
            "name their certificate's file in SSL_CERT_FILE"
        )
    if isinstance(cause, ssl.SSLError):
        return NoSeasonError(
            f"{url} does not speak TLS ({cause.reason}): does its address begin with http://?"
        )
    if isinstance(error, httpx.TimeoutException):
        return UnreachableError(f"{url} does not answer in time")
    if isinstance(error, httpx.RemoteProtocolError | httpx.DecodingError):
        return UnreachableError(f"{url} ended the connection, or does not speak HTTP: {error}")
    reason = getattr(cause, "strerror", None) or str(error) or type(error).__name__
    return UnreachableError(f"cannot reach {url}: {reason}")


def _root(error: BaseException) -> BaseException:
    """Return what caused an error in the first place."""
    seen = [error]
    while (cause := seen[-1].__cause__ or seen[-1].__context__) is not None and cause not in seen:
        seen.append(cause)
    known = (ssl.SSLError, OSError)
    return next((one for one in reversed(seen) if isinstance(one, known)), error)
