//! Files that readers find in the tests, all in memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use plume::graph::Outside;

/// Files by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files(pub BTreeMap<PathBuf, Vec<u8>>);

impl Files {
    pub fn one(name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        [(name, bytes)].into_iter().collect()
    }

    /// The files of a folder by relative path, except those in `bad`.
    pub fn folder(folder: &Path) -> Self {
        let mut files = Self::default();
        let mut folders = vec![folder.to_path_buf()];
        while let Some(next) = folders.pop() {
            for entry in fs::read_dir(&next).into_iter().flatten() {
                let path = entry.expect("it is in the repository").path();
                if path.is_dir() && !path.ends_with("bad") {
                    folders.push(path);
                } else if path.is_file() {
                    let name = path.strip_prefix(folder).expect("it is below").to_owned();
                    files.0.insert(name, fs::read(&path).expect("it is in the repository"));
                }
            }
        }
        files
    }
}

impl<Name: Into<PathBuf>, Bytes: Into<Vec<u8>>> FromIterator<(Name, Bytes)> for Files {
    fn from_iter<All: IntoIterator<Item = (Name, Bytes)>>(all: All) -> Self {
        Self(all.into_iter().map(|(name, bytes)| (name.into(), bytes.into())).collect())
    }
}

impl Outside for Files {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}
