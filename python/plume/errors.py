"""What Plume raises.

The text of an exception says what went wrong, where, and on a line of its own what to do about it: the words of the
command line. Its options are keywords here: what it calls `--force` is `force=True`.
"""

from collections.abc import Iterable
from typing import NamedTuple

__all__ = ["Fault", "InputError", "MissingPartError", "PlumeError", "RecipeError", "StorageError"]


class PlumeError(Exception):
    """The base of what Plume raises."""

    hint: str
    """What to do about it; may be empty."""

    def __init__(self, message: str, hint: str = "") -> None:
        """An error with a text and a hint."""
        super().__init__(f"{message}\n hint: {hint}" if hint else message)
        self.hint = hint


class InputError(PlumeError, ValueError):
    """What was asked for cannot be: no such target, a graph that is none, a cave out of reach."""


class Fault(NamedTuple):
    """One fault of a recipe or of options."""

    origin: str
    """The file, or the `key=value` that was laid over it."""
    line: int | None
    """Line in the file, counted from 1; None where there are no lines."""
    message: str
    """What is wrong, naming the key."""
    hint: str
    """What to do about it; may be empty."""


class RecipeError(InputError):
    """Settings that cannot be: all their faults at once."""

    faults: tuple[Fault, ...]
    """Every fault; never empty."""

    def __init__(self, message: str, faults: Iterable[Fault] = ()) -> None:
        """An error with a text and the faults that it tells."""
        super().__init__(message)
        self.faults = tuple(faults)


class MissingPartError(PlumeError, ImportError):
    """A library that the target is written by is not there, or of another version."""


class StorageError(PlumeError, OSError):
    """A file or folder is missing, damaged, in use or in the way, or the disk refuses."""
