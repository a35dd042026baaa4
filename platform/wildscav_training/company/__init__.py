"""Held-out company: scenarios in which agents meet others that nothing else lets them play with.

The folders beside this file are those others: submissions, written with ``wildscav.skills``. They are not
robots, so neither environments nor suites can draw them, and their kernels cost nobody any time to compile.
"""
