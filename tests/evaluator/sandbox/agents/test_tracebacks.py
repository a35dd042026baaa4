"""What is read of an agent's output about its failure: the exception, its line, and where code was stuck."""

from pathlib import Path

import pytest

from wildscav_evaluator.sandbox.agents.tracebacks import last_words, overdue_stack

CODE = (Path("/submission"), Path("/home/ann/agent"))

EXCEPTION = """
playing
Traceback (most recent call last):
  File "/submission/agent.py", line 9, in act
    return self.plan()
           ^^^^^^^^^^^
  File "/submission/plans/route.py", line 31, in plan
    return np.zeros(-1)
  File "/usr/lib/python3/numpy/core.py", line 5, in zeros
    raise ValueError(message)
ValueError: negative dimensions
are not allowed
"""

UNREADABLE = """  File "/submission/agent.py", line 3
    def act(self, observation:
           ^
SyntaxError: '(' was never closed
"""

STACKS = """
Timeout (0:00:30.600000)!
Thread 0x00007f49e62fe6c0 (most recent call first):
  File "/usr/lib/python3.11/threading.py", line 982 in run

Thread 0x00007f49eedbdb80 (most recent call first):
  File "/usr/lib/python3.11/json/decoder.py", line 353 in raw_decode
  File "/home/ann/agent/agent.py", line 5 in think
  File "/home/ann/agent/agent.py", line 10 in act
  File "/usr/lib/python3/wildscav/sdk/run.py", line 126 in call
  File "/usr/lib/python3/wildscav/sdk/run.py", line 102 in _play
later
Timeout (0:00:01)!
Thread 0x00007f49eedbdb80 (most recent call first):
  File "/home/ann/agent/agent.py", line 99 in later
  File "/usr/lib/python3/wildscav/sdk/run.py", line 126 in call
"""


def test_an_exception_comes_with_the_innermost_line_of_the_agents_own_code() -> None:
    words = last_words(EXCEPTION.splitlines(), CODE)

    assert words == "ValueError: negative dimensions (plans/route.py:31, in plan)"


def test_an_exception_of_foreign_code_alone_comes_with_that_line() -> None:
    lines = EXCEPTION.replace("/submission/", "/elsewhere/").splitlines()

    assert last_words(lines, CODE).endswith("(/usr/lib/python3/numpy/core.py:5, in zeros)")


@pytest.mark.parametrize("begin", ["", EXCEPTION.partition("    return")[0].lstrip()])
def test_code_that_python_cannot_read_is_named_by_its_line(begin: str) -> None:
    words = last_words(f"playing\n{begin}{UNREADABLE}".splitlines(), CODE)

    assert words == "SyntaxError: '(' was never closed (agent.py:3)"


def test_output_without_an_exception_is_told_by_its_last_line() -> None:
    assert last_words(["one", "two", ""], CODE) == "two"
    assert last_words([], CODE) == ""


def test_the_step_that_took_too_long_is_named_by_the_agents_own_lines() -> None:
    assert overdue_stack(STACKS.splitlines(), CODE) == "agent.py:5, in think, called from agent.py:10, in act"


def test_without_stacks_nothing_is_made_up() -> None:
    assert overdue_stack(EXCEPTION.splitlines(), CODE) == ""
    assert overdue_stack(["Timeout (0:00:30)!"], CODE) == ""
