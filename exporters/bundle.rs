//! Kinds of files that hold a whole package.
//!
//! ```
//! use plume_exporters::bundle::Bundle;
//!
//! assert_eq!(Bundle::TarZst.file("caves/mine".as_ref()).to_str(), Some("caves/mine.tar.zst"));
//! ```

use std::path::{Path, PathBuf};

/// A kind of archive for a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bundle {
    /// A zip: supported everywhere.
    Zip,
    /// A tar compressed with Zstandard: smaller.
    TarZst,
    /// A tar compressed with gzip, everything below `package/`: installable with npm and the Unity Package Manager.
    Tgz,
    /// MuJoCo's archive: a zip whose model is called `model.xml`.
    Mjz,
}

impl Bundle {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Zip, Self::TarZst, Self::Tgz, Self::Mjz];

    /// Kinds supported by all targets.
    pub const COMMON: [Self; 2] = [Self::Zip, Self::TarZst];

    /// Name on the command line, and file extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zip => "zip",
            Self::TarZst => "tar.zst",
            Self::Tgz => "tgz",
            Self::Mjz => "mjz",
        }
    }

    /// The file for `output`: the extension is added if it is missing.
    pub fn file(self, output: &Path) -> PathBuf {
        let extension = format!(".{}", self.name());
        match output.as_os_str().as_encoded_bytes().ends_with(extension.as_bytes()) {
            true => output.to_owned(),
            false => with_suffix(output, &extension),
        }
    }
}

/// The path with a suffix.
fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(suffix);
    name.into()
}
