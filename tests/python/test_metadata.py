"""What an index shows about the Python package: it has no files beside it, so every link is absolute and leads to a file of ours."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
REPOSITORY = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["repository"]


def led_to(link):
    """The file of the repository that a link leads to."""
    assert link.startswith(REPOSITORY), link
    return ROOT / re.sub(r"^/(blob|raw)/main/", "", link.removeprefix(REPOSITORY))


def test_links_are_absolute_and_lead_to_files():
    links = re.findall(r"\]\(([^)]+)\)", (ROOT / PROJECT["readme"]).read_text())
    assert len(links) > 5
    for link in [*links, *PROJECT["urls"].values()]:
        assert link == f"{REPOSITORY}/issues" or link == REPOSITORY or led_to(link).is_file(), link


def test_every_python_that_is_named_is_allowed():
    first = int(re.fullmatch(r">=3\.(\d+)", PROJECT["requires-python"])[1])
    named = re.findall(r"Python :: 3\.(\d+)", "\n".join(PROJECT["classifiers"]))
    assert int(named[0]) == first
    assert f'"abi3-py3{first}"' in (ROOT / "python/Cargo.toml").read_text()
