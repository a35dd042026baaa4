"""Finding the cause of a failure in an agent's output, from Python's tracebacks.

Two kinds occur. An exception's traceback names the innermost frame last, and then the exception. (If Python
cannot read the agent's module, it has only that line and the SyntaxError.) The stacks that the SDK prints
when an agent's time is up (``wildscav.sdk.run``) name the innermost frame first.
"""

import re
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

EXCEPTION = "Traceback (most recent call last):"
TIME_IS_UP = re.compile(r"Timeout \(\d+:\d\d:\d\d(\.\d+)?\)!")
THREAD = re.compile(r"(Current t|T)hread 0x[0-9a-f]+.* \(most recent call first\):")
FRAME = re.compile(r'  File "(?P<file>[^"]+)", line (?P<line>\d+)(?:,? in (?P<function>.+))?')
SDK = re.compile(r"wildscav/sdk/\w+\.py$")
CALLERS = 3  # frames of a stack that are reported


class Frame(NamedTuple):
    """A frame of a traceback: the line of code that was being run."""

    file: str  # as Python names it
    line: int
    function: str  # empty for a line that Python could not read


def last_words(lines: Sequence[str], folders: Sequence[Path]) -> str:
    """Return the last exception in the output and where it was raised; without one, the last line, if any.

    A place outside the folders of the agent's code is named only if no frame is inside.
    """
    starts = [number for number, line in enumerate(lines) if line.startswith(EXCEPTION) or _unread(line)]
    if starts:
        # The frames are indented; the exception's message may have several lines.
        for number in range(starts[-1] + 1, len(lines)):
            line = lines[number]
            if line.strip() and not line[0].isspace():
                frames = read_frames(lines[starts[-1] : number])
                return line.strip() + _where(list(reversed(frames)), folders)
    return next((line.strip() for line in reversed(lines) if line.strip()), "")


def _where(frames: Sequence[Frame], folders: Sequence[Path]) -> str:
    """Return the place of the first frame in the agent's code, or of the first frame, in brackets."""
    own = [frame for frame in frames if _within(frame.file, folders)]
    return f" ({_place((own or frames)[0], folders)})" if frames else ""


def overdue_stack(lines: Sequence[str], folders: Sequence[Path]) -> str:
    """Return where the agent's code was when its time was up, in a few words; an empty text if unknown."""
    starts = [number for number, line in enumerate(lines) if TIME_IS_UP.fullmatch(line)]
    if not starts:
        return ""
    # The first such traceback of a match is from the step that used up the time.
    threads = _threads(lines[starts[0] + 1 :])
    stacks = [stack for frames in threads if (stack := _above_sdk(frames))]
    stack = stacks[-1] if stacks else []  # the SDK runs in the main thread, which is printed last
    # Frames of libraries that the agent called are left out, so that its own code is named.
    own = [frame for frame in stack if _within(frame.file, folders)]
    return ", called from ".join(_place(frame, folders) for frame in (own or stack)[:CALLERS])


def _threads(lines: Sequence[str]) -> list[list[Frame]]:
    """Return the stacks at the beginning of some lines, one per thread."""
    threads: list[list[Frame]] = []
    for line in lines:
        if THREAD.match(line):
            threads.append([])
        elif threads and (frames := read_frames([line])):
            threads[-1] += frames
        elif line.strip():
            break
    return threads


def _above_sdk(frames: Sequence[Frame]) -> list[Frame]:
    """Return the frames of a stack, innermost first, that the SDK's code called, if any."""
    for number, frame in enumerate(frames):
        if SDK.search(frame.file):
            return list(frames[:number])
    return []


def read_frames(lines: Sequence[str]) -> list[Frame]:
    """Return the frames that some lines of a traceback name, in their order."""
    matches = (FRAME.fullmatch(line) for line in lines)
    return [Frame(one["file"], int(one["line"]), one["function"] or "") for one in matches if one]


def _unread(line: str) -> bool:
    """Return whether a line names code that Python could not read."""
    return any(not frame.function for frame in read_frames([line]))


def _within(file: str, folders: Sequence[Path]) -> bool:
    return any(PurePosixPath(file).is_relative_to(folder) for folder in folders)


def _place(frame: Frame, folders: Sequence[Path]) -> str:
    """Return a place such as "agent.py:12, in act"; paths in the agent's folder are relative to it."""
    path = PurePosixPath(frame.file)
    for folder in folders:
        if path.is_relative_to(folder):
            path = path.relative_to(folder)
            break
    return f"{path}:{frame.line}" + (f", in {frame.function}" if frame.function else "")
