"""Copies the docstrings of the extension module into its stub, where editors look for them.

    python python/document_stub.py

They are written in Rust, next to the code; a test compares the stub with them.
"""

import ast
import inspect
import textwrap
from pathlib import Path
from typing import Any

from plume import _plume

STUB = Path(__file__).parent / "plume" / "_plume.pyi"


def documented(stub: str) -> str:
    """The text of the stub with every public class, function and member documented."""
    lines = stub.splitlines()
    for node, thing in reversed(list(public(ast.parse(stub), _plume))):
        doc = inspect.getdoc(thing)
        if doc is not None:
            place(lines, node, quoted(doc, " " * (node.col_offset + 4)))
    return "\n".join(lines) + "\n"


def public(tree: ast.Module | ast.ClassDef, owner: Any) -> Any:
    """Definitions of the stub in order, each with the object it describes."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
            thing = getattr(owner, node.name)
            yield node, thing
            if isinstance(node, ast.ClassDef):
                yield from public(node, thing)


def place(lines: list[str], node: ast.ClassDef | ast.FunctionDef, doc: list[str]) -> None:
    """Replaces the existing docstring, or the dots of a function, with the docstring."""
    first = node.body[0]
    end = first.end_lineno or first.lineno
    is_old = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
    if not is_old:
        start = min([first.lineno, *(d.lineno for d in getattr(first, "decorator_list", []))])
        lines[start - 1 : start - 1] = doc
        return
    head = lines[first.lineno - 1][: first.col_offset].rstrip()
    lines[first.lineno - 1 : end] = [head, *doc] if head else doc


def quoted(doc: str, indent: str) -> list[str]:
    """The lines of a docstring."""
    opening = 'r"""' if "\\" in doc else '"""'
    body = opening + doc + ('\n"""' if "\n" in doc else '"""')
    return textwrap.indent(body, indent).splitlines()


if __name__ == "__main__":
    STUB.write_text(documented(STUB.read_text()))
