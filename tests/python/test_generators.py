"""Generators written in Python."""

import json
import random
import threading
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import plume
import pytest

COARSE = {"mesh.voxel_m": 0.5, "texture.size_px": 256}
TURNS = {"type": "integer", "minimum": 1, "maximum": 9, "default": 2, "description": "Number of bends."}


def zigzag(seed: int, settings: dict[str, Any]) -> dict[str, Any]:
    dice = random.Random(seed)
    turns = settings["turns"]
    places = [(8.0 * i, dice.uniform(3.0, 6.0) * (i % 2), 0.0) for i in range(turns + 2)]
    nodes = [
        {"id": i, "coordinates": dict(zip("xyz", place, strict=True)), "edges": [i + 1] if i <= turns else []}
        for i, place in enumerate(places)
    ]
    return {"nodes": nodes}


@pytest.fixture
def name() -> Iterator[str]:
    """A new name, because registrations last for the whole process."""
    yield f"python-{next(NUMBERS)}"


NUMBERS = count()


def test_recipes_name_it_and_its_settings(name: str) -> None:
    plume.register_generator(name, zigzag, summary="bends", settings={"turns": TURNS})
    assert plume.generators()[name] == "bends"
    recipe = plume.Recipe({"graph.generator": name, "graph.turns": 4})
    assert "Number of bends." in recipe.to_toml()
    assert plume.Recipe.parse(recipe.to_toml()) == recipe
    with pytest.raises(plume.RecipeError, match=r"graph\.turns"):
        recipe.replace({"graph.turns": 10})
    with pytest.raises(plume.RecipeError, match=r"graph\.bends"):
        recipe.replace({"graph.bends": 1})


@pytest.mark.parametrize("generator", ["mine", "layers"])
def test_other_recipes_stay_as_they_are(name: str, generator: str) -> None:
    before = plume.Recipe({"graph.generator": generator}).to_toml()
    plume.register_generator(name, zigzag)
    assert plume.Recipe({"graph.generator": generator}).to_toml() == before
    with pytest.raises(plume.RecipeError, match=name):
        plume.Recipe({"graph.generator": "unheard-of"})


def test_the_same_seed_gives_the_same_cave(name: str, tmp_path: Path) -> None:
    threads = []

    def noted(seed: int, settings: dict[str, Any]) -> str:
        threads.append(threading.get_ident())
        return json.dumps(zigzag(seed, settings))

    plume.register_generator(name, noted, settings={"turns": TURNS})
    recipe = plume.Recipe({"graph.generator": name, **COARSE}, seed=5)
    with plume.generate(recipe, folder=tmp_path / "first") as first, plume.generate(recipe) as again:
        assert first.graph.to_dict() == again.graph.to_dict()
        assert np.array_equal(first.chunks[0].positions, again.chunks[0].positions)
        first.export("obj", tmp_path / "package")
        positions = first.graph.positions
    with plume.generate(recipe, seed=6) as other:
        assert not np.array_equal(other.graph.positions, positions)
    assert len(threads) == 3 and threading.get_ident() not in threads
    with plume.open(tmp_path / "first") as opened:
        assert opened.recipe == recipe


@pytest.mark.parametrize(
    ("returned", "told"),
    [
        ({"nodes": []}, "the function returned no graph"),
        ("no JSON", "the function returned no graph"),
        (None, "the function failed: TypeError: 'None' is not"),
        ({"nodes": {1, 2}}, "the function raised TypeError"),
        ([1, 2], "the function failed: TypeError: 'list' object is not"),
    ],
)
def test_an_invalid_graph_is_an_input_error(name: str, returned: Any, told: str) -> None:
    plume.register_generator(name, lambda seed, settings: returned)
    with pytest.raises(plume.InputError, match=told):
        plume.generate({"graph.generator": name})


def test_what_a_function_raises_is_told_with_its_place(name: str) -> None:
    def broken(seed: int, settings: dict[str, Any]) -> dict[str, Any]:
        raise ValueError("out of ore")

    plume.register_generator(name, broken)
    with pytest.raises(plume.InputError, match="the function raised ValueError: out of ore") as caught:
        plume.generate({"graph.generator": name})
    assert "in broken" in caught.value.hint


@pytest.mark.parametrize(
    ("taken", "settings", "told"),
    [
        ("mine", {}, "already taken"),
        ("My Mine", {}, "not a name"),
        (None, {"turns": {"type": "integer"}}, "has no default"),
        (None, {"turns": {"type": "integre", "default": 3}}, "has no type"),
        (None, {"turns": 3}, "has no type"),
        (None, {"generator": TURNS}, "is called"),
    ],
)
def test_what_cannot_be_registered_is_refused(name: str, taken: str | None, settings: Any, told: str) -> None:
    with pytest.raises(plume.InputError, match=told):
        plume.register_generator(taken or name, zigzag, settings=settings)
    assert (taken or name) not in plume.generators() or taken == "mine"
