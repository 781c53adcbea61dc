"""Datasets in an object store and as shards, read by s3fs, webdataset, pandas and pyarrow."""

import io
import json
import os
import subprocess
import sys
import zipfile

import pandas
import plume
import pyarrow.csv
import pytest
import s3fs
import webdataset
from moto.server import ThreadedMotoServer
from plume import publish

SPEC = """
name = "five"
seeds = [1, 5]
targets = ["obj"]
robot = "rover"
sheet = 1
set = ["graph.nodes=3", "mesh.voxel_m=0.5", "texture.size_px=256", "things.cover=0"]
[split]
train = 3
validation = 1
test = 1
"""
SECRETS = {"key": "a", "secret": "b"}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    folder = tmp_path_factory.mktemp("publish")
    (folder / "five.toml").write_text(SPEC, encoding="utf-8")
    return plume.dataset(folder / "five.toml", folder / "five")


@pytest.fixture(scope="module")
def bucket():
    """The options of an S3-compatible server of this machine, which has a bucket."""
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    host, port = server.get_host_and_port()
    options = {**SECRETS, "endpoint_url": f"http://{host}:{port}"}
    s3fs.S3FileSystem(**options, skip_instance_cache=True).mkdir("caves")
    yield options
    server.stop()


def test_a_copy_has_all_files_and_resumes(dataset, bucket):
    names = [line.split("  ", 1)[1] for line in (dataset.path / "SHA256SUMS").read_text().splitlines()]
    assert publish.copy(dataset.path, "s3://caves/five", **bucket) == len(names) + 1
    store = s3fs.S3FileSystem(**bucket, skip_instance_cache=True)
    for name in [*names, "SHA256SUMS"]:
        assert store.cat_file(f"caves/five/{name}") == (dataset.path / name).read_bytes(), name
    # As after an interruption: one file is missing, another was cut off.
    store.rm_file(f"caves/five/{names[0]}")
    store.pipe_file(f"caves/five/{names[1]}", b"cut")
    assert publish.copy(dataset.path, "s3://caves/five", **bucket) == 3
    store.invalidate_cache()
    assert store.cat_file(f"caves/five/{names[1]}") == (dataset.path / names[1]).read_bytes()


def test_a_copy_is_a_dataset(dataset, tmp_path):
    publish.copy(dataset.path, str(tmp_path / "copy"))
    subprocess.run([sys.executable, "-m", "plume", "check", "copy"], cwd=tmp_path, check=True)


def test_the_command_publishes(dataset, bucket, tmp_path):
    environment = {f"FSSPEC_S3_{key.upper()}": value for key, value in bucket.items()}

    def command(*arguments):
        line = [sys.executable, "-m", "plume", "publish", *arguments]
        return subprocess.run(line, env={**os.environ, **environment}, cwd=tmp_path, capture_output=True, text=True)

    names = [line.split("  ", 1)[1] for line in (dataset.path / "SHA256SUMS").read_text().splitlines()]
    done = command(str(dataset.path), "s3://caves/by-command", "--json")
    assert json.loads(done.stdout) == {"url": "s3://caves/by-command", "files": len(names) + 1}, done.stderr
    store = s3fs.S3FileSystem(**bucket, skip_instance_cache=True)
    assert store.cat_file("caves/by-command/SHA256SUMS") == (dataset.path / "SHA256SUMS").read_bytes()
    done = command(str(dataset.path), "shards", "--shards", "2")
    assert (done.returncode, done.stderr) == (0, "  published shards  4 shards\n")
    assert len(list((tmp_path / "shards").glob("*.tar"))) == 4
    for arguments, code, told in [
        (("nowhere", "copy"), 2, "error: nowhere is no finished dataset\n hint: make one with `plume dataset`\n"),
        ((str(dataset.path), "nope://copy"), 2, "error: nope://copy is no place that fsspec knows"),
        ((str(dataset.path), str(tmp_path / "shards/train-000000.tar/copy")), 1, "error: "),
    ]:
        done = command(*arguments)
        assert done.returncode == code, done.stderr
        assert done.stderr.startswith(told), done.stderr
        assert "Traceback" not in done.stderr


def test_webdataset_reads_the_shards(dataset, tmp_path):
    names = publish.shards(dataset.path, str(tmp_path / "shards"), caves=2)
    assert names == ["train-000000.tar", "train-000001.tar", "validation-000000.tar", "test-000000.tar"]
    urls = [str(tmp_path / "shards" / name) for name in names]
    samples = list(webdataset.WebDataset(urls, shardshuffle=False))
    rows = {row["item"]: row for row in dataset.caves}
    assert sorted(int(sample["__key__"]) for sample in samples) == sorted(rows)
    for sample in samples:
        row = rows[int(sample["__key__"])]
        assert json.loads(sample["json"]) == row
        folder = dataset.path / row["path"]
        assert sample["toml"] == (folder / "recipe.toml").read_bytes()
        assert sample["certificate.json"] == (folder / "certificate.json").read_bytes()
        with zipfile.ZipFile(io.BytesIO(sample["obj.zip"])) as package:
            assert package.read("manifest.json") == (folder / "obj" / "manifest.json").read_bytes()
            package.extractall(tmp_path / "packages" / sample["__key__"])
        assert plume_checks(tmp_path / "packages" / sample["__key__"])


def test_shards_in_an_object_store_are_the_same(dataset, bucket, tmp_path):
    names = publish.shards(dataset.path, "s3://caves/shards", **bucket)
    publish.shards(dataset.path, str(tmp_path))
    store = s3fs.S3FileSystem(**bucket, skip_instance_cache=True)
    assert [store.cat_file(f"caves/shards/{name}") for name in names] == [
        (tmp_path / name).read_bytes() for name in names
    ]


def test_what_was_changed_is_not_published(dataset, tmp_path):
    publish.copy(dataset.path, str(tmp_path / "copy"))
    (tmp_path / "copy/items/000002/recipe.toml").write_text("seed = 9")
    with pytest.raises(plume.StorageError, match="recipe.toml was changed"):
        publish.copy(tmp_path / "copy", str(tmp_path / "again"))
    assert not (tmp_path / "again/SHA256SUMS").exists()
    with pytest.raises(plume.StorageError, match="recipe.toml was changed"):
        publish.shards(tmp_path / "copy", str(tmp_path / "shards"))
    with pytest.raises(plume.InputError, match="is no finished dataset"):
        publish.copy(tmp_path, str(tmp_path / "nowhere"))


def test_pandas_and_pyarrow_read_the_index(dataset):
    table = pandas.read_csv(dataset.path / "index.csv")
    arrow = pyarrow.csv.read_csv(dataset.path / "index.csv")
    assert list(table.columns) == arrow.column_names == list(dataset.caves[0])
    for key in ("item", "length_m", "triangles"):
        assert table[key].tolist() == arrow[key].to_pylist() == [row[key] for row in dataset.caves]
    assert pandas.read_json(dataset.path / "index.json")["graph_sha256"].tolist() == table["graph_sha256"].tolist()


def plume_checks(package):
    return subprocess.run([sys.executable, "-m", "plume", "check", str(package), "--quiet"]).returncode == 0
