"""A gateway for the tests of this folder."""

from tests.evaluator.model_gateway.served import serve

__all__ = ("serve",)
