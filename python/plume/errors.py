"""The exceptions of Plume.

The text of an exception says what went wrong, where, and on a separate line what to do about it, in the words of the
command line. Options of the command line are keywords here: `--force` is `force=True`.
"""

from collections.abc import Iterable
from typing import NamedTuple

__all__ = ["Fault", "InputError", "MissingPartError", "PlumeError", "RecipeError", "StorageError"]


class PlumeError(Exception):
    """Base class of the exceptions of Plume."""

    hint: str
    """What to do about it; may be empty."""

    def __init__(self, message: str, hint: str = "") -> None:
        """An error with a text and a hint."""
        super().__init__(f"{message}\n hint: {hint}" if hint else message)
        self.hint = hint


class InputError(PlumeError, ValueError):
    """The request is impossible: an unknown target, an invalid graph, a cave that is too large."""


class Fault(NamedTuple):
    """One fault of a recipe or of options."""

    origin: str
    """The file, or the `key=value` override."""
    line: int | None
    """Line in the file, counted from 1; None if it has no lines."""
    message: str
    """What is wrong, naming the key."""
    hint: str
    """What to do about it; may be empty."""


class RecipeError(InputError):
    """Invalid settings, with all their faults."""

    faults: tuple[Fault, ...]
    """Every fault; never empty."""

    def __init__(self, message: str, faults: Iterable[Fault] = ()) -> None:
        """An error with a text and the faults it reports."""
        super().__init__(message)
        self.faults = tuple(faults)


class MissingPartError(PlumeError, ImportError):
    """A library needed to write the target is missing, or has an unsupported version."""


class StorageError(PlumeError, OSError):
    """A file or folder is missing, damaged, in use or in the way, or the disk fails."""
