"""The exceptions of Plume.

The text of an exception says what went wrong, where, and on a separate line what to do about it.
"""

import os
from collections.abc import Iterable
from typing import Any, NamedTuple

__all__ = [
    "Fault",
    "InputError",
    "MissingFileError",
    "MissingPartError",
    "PlumeError",
    "RecipeError",
    "StorageError",
]


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
    """A file or folder is missing, damaged, in use or in the way, or the disk fails.

    `errno` and `filename` are set where the system refuses a file.
    """

    def __init__(
        self, message: str, hint: str = "", errno: int | None = None, filename: str | os.PathLike[str] | None = None
    ) -> None:
        """An error with a text, a hint, and what the system says of which file."""
        super().__init__(message, hint)
        if errno is not None:
            self.errno, self.strerror = errno, os.strerror(errno)
        if filename is not None:
            self.filename = os.fspath(filename)

    def __str__(self) -> str:
        """The text, which names the file in its own way."""
        return str(self.args[0])

    def __reduce__(self) -> tuple[Any, ...]:
        """Keeps what is known of the file where the exception is sent to another process."""
        known = {"errno": self.errno, "strerror": self.strerror, "filename": self.filename}
        return type(self), self.args, {**vars(self), **known}


class MissingFileError(StorageError, FileNotFoundError):
    """There is no such file or folder."""
