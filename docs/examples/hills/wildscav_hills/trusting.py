"""A sandbox that trusts everybody."""

from wildscav_evaluator.sandbox.process import ProcessSandbox


class TrustingSandbox(ProcessSandbox):
    """Runs an agent as a plain process, under another name."""

    name = "trusting"
