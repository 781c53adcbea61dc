"""Runs what a page of the documentation says, in order, in the current folder.

    python tests/python/docs_page.py docs/gazebo.md

- In a fence `console`, lines that begin with `$ ` are commands; a backslash at the end continues them.
- A fence `python` is a program; those of a page share their names. `python ignore` does not run.
- A fence with `file=NAME` is written to that file.

No other fence runs. The first step that fails ends it, with page, line and what was said.
"""

import os
import subprocess
import sys
import threading
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

LIMIT_S = 300
"""For each step; machines that test are slow and shared."""
FENCE = "```"


@dataclass(frozen=True)
class Step:
    """A command, a program, or a file to be written: `kind` is "console", "python" or "file NAME"."""

    kind: str
    line: int
    text: str


def steps(page: str) -> Iterator[Step]:
    """What runs of the text of a page."""
    lines = enumerate(page.splitlines(), 1)
    for opening, line in lines:
        if line.startswith(FENCE):
            block = []
            for _, inner in lines:
                if inner == FENCE:
                    break
                block.append(inner)
            else:
                raise ValueError(f"the fence of line {opening} does not end")
            yield from steps_of_block(line.removeprefix(FENCE).split(), block, opening + 1)


def steps_of_block(words: list[str], block: list[str], line: int) -> Iterator[Step]:
    language, flags = (words or [""])[0], words[1:]
    files = [flag.removeprefix("file=") for flag in flags if flag.startswith("file=")]
    text = "".join(f"{line}\n" for line in block)
    if files:
        yield Step(f"file {files[0]}", line, text)
    elif language == "python" and "ignore" not in flags:
        yield Step("python", line, text)
    elif language == "console":
        yield from commands(block, line)


def commands(block: list[str], first: int) -> Iterator[Step]:
    lines = enumerate(block, first)
    for number, line in lines:
        if line.startswith("$ "):
            command = line.removeprefix("$ ")
            while command.endswith("\\"):
                command += "\n" + next(lines)[1]
            yield Step("console", number, command)


def run(step: Step, page: str, names: dict[str, object]) -> str | None:
    """Runs a step; returns what is wrong, if anything is."""
    if step.kind.startswith("file "):
        Path(step.kind.removeprefix("file ")).write_text(step.text)
        return None
    if step.kind == "console":
        result = subprocess.run(["bash", "-c", step.text], capture_output=True, text=True)
        return None if result.returncode == 0 else f"exit code {result.returncode}\n{result.stderr}"
    try:
        # Blank lines before it, so that a traceback has the lines of the page.
        exec(compile("\n" * (step.line - 1) + step.text, page, "exec"), names)
    except Exception:
        return traceback.format_exc()
    return None


def give_up(place: str) -> None:
    print(f"{place}\ntook longer than {LIMIT_S} s", file=sys.stderr, flush=True)
    os._exit(1)


def main(page: str) -> int:
    names: dict[str, object] = {"__name__": "__main__"}
    for step in steps(Path(page).read_text()):
        shown = step.text if step.kind == "console" else step.kind
        place = f"{page}:{step.line}: {shown}"
        timer = threading.Timer(LIMIT_S, give_up, [place])
        timer.start()
        wrong = run(step, page, names)
        timer.cancel()
        if wrong is not None:
            print(f"{place}\n{wrong}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
