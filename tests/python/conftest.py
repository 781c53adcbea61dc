"""A small cave as USD packages, made once."""

import subprocess
import sys

import pytest


@pytest.fixture(scope="session")
def packages(tmp_path_factory):
    """Folder of the packages `isaac`, `usd` and `usdz` of one small cave."""
    folder = tmp_path_factory.mktemp("packages")
    arguments = ["export", "--target", "isaac,usd,usdz", "--output", str(folder), "--quiet"]
    small = ["--set", "graph.nodes=12", "--set", "texture.size_px=256"]
    subprocess.run([sys.executable, "-m", "plume", *arguments, *small], check=True)
    return folder
