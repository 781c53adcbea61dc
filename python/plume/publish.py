"""Finished datasets elsewhere: in an object store, or as shards for streaming.

    from plume import publish

    publish.copy("drive", "s3://bucket/drive")
    publish.shards("drive", "s3://bucket/drive-shards", caves=100)

URLs are those of fsspec: a folder, `s3://` with s3fs, `gs://` with gcsfs, and many more. Needs fsspec:
`pip install plume-caves[publish]`, and the package of the store.
"""

import hashlib
import io
import json
import tarfile
import zipfile
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any

from plume.errors import InputError, MissingPartError, StorageError

__all__ = ["copy", "shards"]

SUMS = "SHA256SUMS"
EPOCH = (1980, 1, 1, 0, 0, 0)
"""The date of all files in archives: the earliest that ZIP has, so that the same dataset gives the same bytes."""


def copy(dataset: str | PathLike[str], url: str, **options: Any) -> int:
    """Copies a finished dataset, and returns how many files were written.

    Files of the same size that are there already stay, so that the same call resumes after an interruption. `SHA256SUMS` is
    written last: where it is, everything is. Every file is checked against its sum as it is read.

    Args:
        dataset: The folder of the dataset.
        url: A folder or URL of fsspec.
        options: Of the file system, as `fsspec.url_to_fs` takes them: credentials, endpoints.
    """
    folder = Path(dataset)
    store, root = _store(url, options)
    written = 0
    for name, expected in _sums(folder):
        place = f"{root}/{name}"
        if store.exists(place) and store.size(place) == (folder / name).stat().st_size:
            continue
        _write(store, place, _checked(folder / name, expected))
        written += 1
    _write(store, f"{root}/{SUMS}", (folder / SUMS).read_bytes())
    return written + 1


def shards(dataset: str | PathLike[str], url: str, *, caves: int = 100, **options: Any) -> list[str]:
    """Writes a finished dataset as WebDataset shards, and returns their names.

    A shard is a TAR archive of up to `caves` caves of one part: `train-000000.tar`. A cave is a sample whose key is its number:
    `000012.json` is its row of the index, `000012.toml` its recipe, `000012.certificate.json` its certificate, if there is one, and
    `000012.mujoco.zip` a package, one for each target. The same dataset gives the same bytes.

    Args:
        dataset: The folder of the dataset.
        url: A folder or URL of fsspec.
        caves: Caves per shard.
        options: Of the file system, as `fsspec.url_to_fs` takes them: credentials, endpoints.
    """
    folder = Path(dataset)
    sums = dict(_sums(folder))
    store, root = _store(url, options)
    names = []
    rows = json.loads(_checked(folder / "index.json", sums["index.json"]))
    for part in ("train", "validation", "test"):
        of_part = [row for row in rows if row["part"] == part]
        for number, first in enumerate(range(0, len(of_part), caves)):
            name = f"{part}-{number:06}.tar"
            store.makedirs(root, exist_ok=True)
            with store.open(f"{root}/{name}", "wb") as file, tarfile.open(fileobj=file, mode="w|") as shard:
                for row in of_part[first : first + caves]:
                    for extension, content in _sample(folder, row, sums):
                        entry = tarfile.TarInfo(f"{row['item']:06}.{extension}")
                        entry.size = len(content)
                        shard.addfile(entry, io.BytesIO(content))
            names.append(name)
    return names


def _sample(folder: Path, row: dict[str, Any], sums: dict[str, str]) -> Iterator[tuple[str, bytes]]:
    """The files of a cave in a shard, by their extensions."""
    below = row["path"]
    files = {name.removeprefix(below + "/"): name for name in sums if name.startswith(below + "/")}

    def read(name: str) -> bytes:
        return _checked(folder / files[name], sums[files[name]])

    yield "json", json.dumps(row).encode()
    yield "toml", read("recipe.toml")
    if "certificate.json" in files:
        yield "certificate.json", read("certificate.json")
    for package in sorted({name.split("/")[0] for name in files if "/" in name}):
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as zipped:
            for name in sorted(name for name in files if name.startswith(package + "/")):
                zipped.writestr(zipfile.ZipInfo(name.removeprefix(package + "/"), EPOCH), read(name))
        yield f"{package}.zip", archive.getvalue()


def _sums(folder: Path) -> Iterator[tuple[str, str]]:
    """Names and SHA-256 of the files of a dataset."""
    try:
        lines = (folder / SUMS).read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        raise InputError(f"{folder} is no finished dataset", "make one with `plume dataset`") from None
    for line in lines:
        expected, name = line.split("  ", 1)
        yield name, expected


def _checked(file: Path, expected: str) -> bytes:
    content = file.read_bytes()
    if hashlib.sha256(content).hexdigest() != expected:
        raise StorageError(f"{file} was changed since the dataset was made", "`plume check` lists what differs")
    return content


def _write(store: Any, place: str, content: bytes) -> None:
    store.makedirs(place.rsplit("/", 1)[0], exist_ok=True)
    with store.open(place, "wb") as file:
        file.write(content)


def _store(url: str, options: dict[str, Any]) -> tuple[Any, str]:
    try:
        import fsspec  # type: ignore[import-untyped]
    except ImportError as error:
        raise MissingPartError(f"fsspec cannot be loaded: {error}", "pip install 'plume-caves[publish]'") from None
    try:
        store, root = fsspec.url_to_fs(url, **options)
    except ImportError as error:
        raise MissingPartError(f"{url} cannot be reached: {error}", "install what fsspec needs for it") from None
    except ValueError as error:
        raise InputError(
            f"{url} is no place that fsspec knows: {error}", "name a folder or a URL such as s3://BUCKET"
        ) from None
    return store, root.rstrip("/")
