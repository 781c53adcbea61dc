"""The files of a package for Unity: their GUIDs and contents."""

import json
import re
from functools import cached_property

from documents import Document, read_documents, read_meta, require
from models import Model
from schema import BY_ENDING, IMPORTERS, check

# What stands for a whole prefab in references to it.
WHOLE_PREFAB = 100100000


class Package:
    """A package whose assets are known by GUID, and whose files all keep to their tables."""

    def __init__(self, folder):
        self.folder = folder
        self.assets = {}
        metas = set(folder.rglob("*.meta"))
        for path in sorted(path for path in folder.rglob("*") if path.suffix != ".meta"):
            meta = path.with_name(path.name + ".meta")
            require(meta in metas, f"{path.relative_to(folder)} has no .meta")
            metas.discard(meta)
            asset = Asset(path, meta)
            require(asset.guid not in self.assets, f"two assets have the GUID {asset.guid}: one is {path.name}")
            self.assets[asset.guid] = asset
        require(not metas, f"these belong to nothing: {sorted(path.name for path in metas)}")
        self.check_manifest()

    def check_manifest(self):
        """https://docs.unity3d.com/Manual/upm-manifestPkg.html"""
        manifest = json.loads((self.folder / "package.json").read_text())
        for key, pattern in (
            ("name", r"com\.[a-z0-9][a-z0-9._-]{1,200}[a-z0-9_-]"),
            ("version", r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)"),
            ("unity", r"\d{4}\.\d"),
            ("displayName", r".+"),
            ("description", r"(?s).+"),
        ):
            value = manifest.get(key)
            require(isinstance(value, str), f"package.json has no {key}")
            require(re.fullmatch(pattern, value), f"package.json has a {key} that is none: {value}")

    def of(self, ending):
        return [asset for asset in self.assets.values() if asset.path.suffix == ending]


class Asset:
    """A file or a folder, and its `.meta`."""

    def __init__(self, path, meta):
        self.path = path
        self.name = path.name
        content = read_meta(meta)
        require(
            isinstance(content, dict) and content.get("fileFormatVersion") == 2, f"{meta.name} is of another format"
        )
        self.guid = str(content.get("guid"))
        require(re.fullmatch("[0-9a-f]{32}", self.guid), f"{meta.name} has no GUID of 32 figures: {self.guid}")
        importer, self.main_object = BY_ENDING.get("" if path.is_dir() else path.suffix, (None, None))
        if path.name == "package.json":
            importer = "PackageManifestImporter"
        require(importer is not None, f"{path.name} is of no known kind")
        require(importer in content, f"{meta.name} has no {importer}")
        require(bool(content.get("folderAsset")) == path.is_dir(), f"{meta.name} is wrong about being a folder's")
        self.importer = content[importer]
        check(self.importer, IMPORTERS[importer], f"{meta.name}: {importer}")
        if importer == "NativeFormatImporter":
            require(self.importer["mainObjectFileID"] == self.main_object, f"{meta.name} names another main object")

    @cached_property
    def documents(self) -> list[Document]:
        return read_documents(self.path)

    @cached_property
    def model(self) -> Model:
        return Model(self.path)

    def has_object(self, file_id):
        """Whether other files can name the object."""
        if self.path.suffix == ".prefab":
            return file_id == WHOLE_PREFAB or any(document.file_id == file_id for document in self.documents)
        return file_id in self.model.meshes if self.path.suffix == ".fbx" else file_id == self.main_object

    @property
    def kind_of_reference(self):
        """2 for what is YAML as it is, 3 for what is imported: https://unity.com/blog/engine-platform/understanding-unitys-serialization-language-yaml"""
        return 2 if "mainObjectFileID" in self.importer else 3
