"""Refusals: encoded as a google.rpc.Status with an ErrorInfo, and decoded to the SDK's exceptions."""

from typing import Any

import grpc
from google.protobuf.any_pb2 import Any as AnyMessage
from google.rpc.error_details_pb2 import ErrorInfo
from google.rpc.status_pb2 import Status
from grpc_status import rpc_status

from wildscav.errors import RefusedError, ServerUnreachableError, WildscavError

DOMAIN = "wildscav"


class RefusalError(WildscavError):
    """The server refuses a call.

    Args:
        reason: One of the reasons listed at the top of ``match.proto``.
    """

    def __init__(self, code: grpc.StatusCode, reason: str, message: str) -> None:
        super().__init__(message)
        self.code, self.reason = code, reason


class ProtocolRefusalError(RefusalError):
    """The server refuses a client that violated the protocol; its seat is closed."""

    def __init__(
        self, reason: str, message: str, code: grpc.StatusCode = grpc.StatusCode.INVALID_ARGUMENT
    ) -> None:
        super().__init__(code, reason, message)


def encode_refusal(refusal: RefusalError) -> grpc.Status:
    """Return a refusal as a status with typed details."""
    detail = AnyMessage()
    detail.Pack(ErrorInfo(reason=refusal.reason, domain=DOMAIN))
    code: int = refusal.code.value[0]
    status: grpc.Status = rpc_status.to_status(Status(code=code, message=str(refusal), details=[detail]))
    return status


def decode_error(error: grpc.RpcError, address: str) -> WildscavError:
    """Return the exception with which the SDK reports a failed call."""
    call: Any = error  # the error is also the call; gRPC does not publish its class
    reason = reason_of(error)
    if reason:
        return RefusedError(reason, call.details() or "the server refused")
    return ServerUnreachableError(
        f"no match server answers at {address}, or it went away: {call.details()} ({call.code().name})"
    )


def reason_of(error: grpc.RpcError) -> str:
    """Return the reason in the typed details of a failed call, or ""."""
    try:
        status = rpc_status.from_call(error)
    except ValueError:  # the details contradict the status, so they are not from our server
        return ""
    for detail in status.details if status else ():
        info = ErrorInfo()
        if detail.Unpack(info) and info.domain == DOMAIN:
            return info.reason
    return ""
