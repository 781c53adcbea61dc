"""The commands and programs of the README and of every page of `docs` run, page by page, in the order in which they stand."""

import os
import subprocess
import sys
from pathlib import Path

import docs_page
import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
TOLD = [page for page in PAGES if any(docs_page.steps(page.read_text()))]
LIMIT_S = 900


@pytest.fixture
def run(binary, tmp_path):
    """Runs a page in a folder of its own, which has `samples` and `examples`, and with `plume` first on `PATH`."""
    programs, folder = tmp_path / "bin", tmp_path / "page"
    programs.mkdir()
    folder.mkdir()
    (programs / "plume").symlink_to(Path(binary).resolve())
    for shown in ("samples", "examples"):
        (folder / shown).symlink_to(ROOT / shown)
    path = os.pathsep.join([str(programs), str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "PLUME_PYTHON": sys.executable}

    def run(page):
        command = [sys.executable, docs_page.__file__, page]
        return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT_S)

    return run


@pytest.mark.parametrize("page", TOLD, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_commands_of_a_page_run(page, run):
    result = run(page)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("```console\n$ true\nnot a command\n$ ls nowhere\n```", 4, "nowhere"),
        ("```console\n$ true && \\\n  plume export --target no\n```", 2, "no"),
        (
            "```console\n$ plume --version\n```\n\n```python\na = 1\n```\n\n```python\na += 1\nassert a == 3\n```",
            10,
            "assert a == 3",
        ),
        ("```toml file=a.toml\nname = 3\n```\n\n```console\n$ plume preview a.toml\n```", 6, "a.toml:1"),
    ],
)
def test_a_fault_is_told_with_its_line(text, line, said, run, tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"{text}\n")
    result = run(page)
    assert result.returncode == 1
    assert result.stderr.startswith(f"{page}:{line}: ")
    assert said in result.stderr


def test_other_fences_do_not_run(run, tmp_path):
    page = tmp_path / "page.md"
    page.write_text("```sh\nfalse\n```\n\n```python ignore\nraise SystemExit(1)\n```\n\n```text\n$ false\n```\n")
    result = run(page)
    assert (result.returncode, result.stderr) == (0, "")
