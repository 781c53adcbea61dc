//! Kinds of files that hold a whole package.

use std::path::{Path, PathBuf};

/// A kind of file that holds a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bundle {
    /// A zip: opened by everything.
    Zip,
    /// A tar, compressed by Zstandard: smaller.
    TarZst,
    /// A tar, compressed by gzip, all of it below `package/`: what npm and the Unity Package Manager install.
    Tgz,
    /// MuJoCo's archive: a zip whose model is called `model.xml`.
    Mjz,
}

impl Bundle {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Zip, Self::TarZst, Self::Tgz, Self::Mjz];

    /// Kinds that hold a package of any target.
    pub const COMMON: [Self; 2] = [Self::Zip, Self::TarZst];

    /// What the user types, and the extension of the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zip => "zip",
            Self::TarZst => "tar.zst",
            Self::Tgz => "tgz",
            Self::Mjz => "mjz",
        }
    }

    /// The file that `output` becomes: the extension is added where it is not there yet.
    pub fn file(self, output: &Path) -> PathBuf {
        let extension = format!(".{}", self.name());
        match output.as_os_str().as_encoded_bytes().ends_with(extension.as_bytes()) {
            true => output.to_owned(),
            false => with_suffix(output, &extension),
        }
    }
}

/// The path with something at its end.
fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(suffix);
    name.into()
}
