//! libassimp, loaded at run time. The only unsafe code of this workspace, behind a safe interface.
//!
//! Signatures and structures are those of the public C headers of assimp 5 and 6 (`cexport.h`, `cimport.h`, `types.h`,
//! `version.h`), whose parts used here are identical; any other version is refused before anything else is called. If the
//! library aborts, so does this program.

#![allow(unsafe_code, reason = "calling a C library loaded at run time requires it")]

use std::ffi::{CStr, CString, OsString, c_char, c_uint, c_void};
use std::ptr::NonNull;
use std::sync::{Mutex, PoisonError};

use crate::error::ExportError;

/// The environment variable that names the library, instead of searching for it.
pub const PATH: &str = "PLUME_ASSIMP";

/// Names of the library on Linux, macOS and Windows.
const NAMES: &[&str] = &[
    "libassimp.so.6",
    "libassimp.so.5",
    "libassimp.so",
    "libassimp.dylib",
    "/opt/homebrew/lib/libassimp.dylib",
    "/usr/local/lib/libassimp.dylib",
    "assimp-vc143-mt.dll",
    "assimp-vc142-mt.dll",
    "assimp.dll",
];

/// Versions whose structures are the ones below.
const MAJORS: [u32; 2] = [5, 6];

/// assimp has one last error text for all threads.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// libassimp, in a supported version.
pub struct Library {
    functions: Functions,
    version: [u32; 2],
    /// The loaded library, which contains the functions.
    _code: libloading::Library,
}

/// A format that assimp writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Format {
    /// assimp's id, e.g. `collada`.
    pub id: String,
    /// File extension, without a dot.
    pub extension: String,
    /// assimp's description.
    pub description: String,
}

/// Receives each file that assimp has written: the end of its name, and its bytes.
pub type Take<'a> = dyn FnMut(&str, &[u8]) -> Result<(), ExportError> + 'a;

type Number = unsafe extern "C" fn() -> c_uint;

/// The functions of the C API that are called, with assimp's names.
struct Functions {
    format_count: unsafe extern "C" fn() -> usize,
    format: unsafe extern "C" fn(usize) -> *const RawFormat,
    release_format: unsafe extern "C" fn(*const RawFormat),
    import: unsafe extern "C" fn(*const c_char, c_uint, c_uint, *const c_char) -> *const c_void,
    release_import: unsafe extern "C" fn(*const c_void),
    export: unsafe extern "C" fn(*const c_void, *const c_char, c_uint) -> *const RawBlob,
    release_blob: unsafe extern "C" fn(*const RawBlob),
    last_error: unsafe extern "C" fn() -> *const c_char,
}

/// `aiExportFormatDesc`.
#[repr(C)]
struct RawFormat {
    id: *const c_char,
    description: *const c_char,
    extension: *const c_char,
}

/// `aiString`.
#[repr(C)]
struct RawText {
    length: u32,
    data: [c_char; 1024],
}

/// `aiExportDataBlob`.
#[repr(C)]
struct RawBlob {
    bytes: usize,
    data: *const u8,
    name: RawText,
    next: *const RawBlob,
}

impl Library {
    /// The library named by [`PATH`], or else the first that the system finds.
    ///
    /// # Errors
    /// [`ExportError::MissingPart`] if there is none in a supported version.
    pub fn load() -> Result<Self, ExportError> {
        match std::env::var_os(PATH) {
            Some(path) => Self::open(&[path]),
            None => Self::open(&NAMES.iter().map(OsString::from).collect::<Vec<_>>()),
        }
    }

    /// The first of these names or paths that the system finds.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn open(names: &[OsString]) -> Result<Self, ExportError> {
        // SAFETY: loading runs the initialisers of the library. The name is assimp's or the user's choice, and assimp's
        // initialisers have no requirements.
        let code = names.iter().find_map(|name| unsafe { libloading::Library::new(name) }.ok());
        let code = code.ok_or_else(|| missing(&format!("is not installed (looked for {})", listed(names))))?;
        Self::of(code).map_err(|fault| missing(&fault))
    }

    fn of(code: libloading::Library) -> Result<Self, String> {
        let foreign = |error: libloading::Error| format!("lacks a function: {error}");
        // SAFETY: both take nothing and return an `unsigned int` in every version of assimp.
        let version = unsafe {
            let major: Number = symbol(&code, c"aiGetVersionMajor").map_err(foreign)?;
            let minor: Number = symbol(&code, c"aiGetVersionMinor").map_err(foreign)?;
            [major(), minor()]
        };
        if !MAJORS.contains(&version[0]) {
            return Err(format!("has version {}.{}, not 5 or 6", version[0], version[1]));
        }
        // SAFETY: the version is one whose functions have the types of `Functions`.
        let functions = unsafe { Functions::of(&code) }.map_err(foreign)?;
        Ok(Self { functions, version, _code: code })
    }

    /// Major and minor version.
    pub fn version(&self) -> [u32; 2] {
        self.version
    }

    /// The formats that it writes.
    pub fn formats(&self) -> Vec<Format> {
        // SAFETY: takes nothing.
        let count = unsafe { (self.functions.format_count)() };
        (0..count).filter_map(|index| self.format(index)).collect()
    }

    fn format(&self, index: usize) -> Option<Format> {
        // SAFETY: the index is below the count. The result is null or ours until it is released, and its strings are
        // zero-terminated.
        unsafe {
            let raw = NonNull::new((self.functions.format)(index).cast_mut())?;
            let [id, extension, description] =
                [raw.as_ref().id, raw.as_ref().extension, raw.as_ref().description].map(|part| text(part));
            (self.functions.release_format)(raw.as_ptr());
            Some(Format { id, extension, description })
        }
    }

    /// Reads a GLB and writes it as `format`. Each file is passed to `take` with its name: empty for the first, otherwise
    /// the part after the dot. The disk is not touched.
    ///
    /// # Errors
    /// [`ExportError::TooLarge`] beyond 4 GiB, [`ExportError::Library`] if assimp fails, and those of `take`.
    pub fn convert(&self, glb: &[u8], format: &str, take: &mut Take<'_>) -> Result<(), ExportError> {
        let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        let length = c_uint::try_from(glb.len()).map_err(|_| ExportError::TooLarge {
            path: format.to_owned(),
            format: "assimp",
            bytes: glb.len() as u64,
        })?;
        let refused = || ExportError::Library {
            library: "assimp",
            path: format!("format `{format}`"),
            message: self.last_error(),
        };
        let id = CString::new(format).map_err(|_| refused())?;
        // SAFETY: the bytes outlive the call and have the given length; the hint is zero-terminated; no flag is set.
        let scene = unsafe { (self.functions.import)(glb.as_ptr().cast(), length, 0, c"glb".as_ptr()) };
        let scene =
            Owned { it: NonNull::new(scene.cast_mut()).ok_or_else(refused)?, release: self.functions.release_import };
        // SAFETY: the scene is assimp's and still owned; the name is zero-terminated; no flag is set.
        let blob = unsafe { (self.functions.export)(scene.it.as_ptr(), id.as_ptr(), 0) };
        let blob =
            Owned { it: NonNull::new(blob.cast_mut()).ok_or_else(refused)?, release: self.functions.release_blob };
        let mut next = Some(blob.it);
        while let Some(file) = next {
            // SAFETY: the chain and its bytes are assimp's and live until the first blob is released, which is after this
            // loop; the name is shorter than its array.
            let (name, bytes) = unsafe { file.as_ref().content() };
            take(&name, bytes)?;
            // SAFETY: as above.
            next = NonNull::new(unsafe { file.as_ref() }.next.cast_mut());
        }
        Ok(())
    }

    fn last_error(&self) -> String {
        // SAFETY: takes nothing, and returns a zero-terminated string that lives until the next call; only one thread calls.
        let message = unsafe { text((self.functions.last_error)()) };
        if message.is_empty() { "no reason given".to_owned() } else { message }
    }
}

impl Functions {
    /// # Safety
    /// The functions of `code` must have the types of the fields.
    unsafe fn of(code: &libloading::Library) -> Result<Self, libloading::Error> {
        // SAFETY: promised by the caller.
        unsafe {
            Ok(Self {
                format_count: symbol(code, c"aiGetExportFormatCount")?,
                format: symbol(code, c"aiGetExportFormatDescription")?,
                release_format: symbol(code, c"aiReleaseExportFormatDescription")?,
                import: symbol(code, c"aiImportFileFromMemory")?,
                release_import: symbol(code, c"aiReleaseImport")?,
                export: symbol(code, c"aiExportSceneToBlob")?,
                release_blob: symbol(code, c"aiReleaseExportBlob")?,
                last_error: symbol(code, c"aiGetErrorString")?,
            })
        }
    }
}

impl RawBlob {
    /// # Safety
    /// The blob must be assimp's and must not be released while the bytes are in use.
    unsafe fn content(&self) -> (String, &[u8]) {
        let name: Vec<u8> = self.name.data.iter().take(self.name.length as usize).map(|&part| part as u8).collect();
        let bytes = match self.data.is_null() {
            true => &[],
            // SAFETY: assimp has allocated `bytes` bytes there.
            false => unsafe { std::slice::from_raw_parts(self.data, self.bytes) },
        };
        (String::from_utf8_lossy(&name).into_owned(), bytes)
    }
}

/// An object owned by assimp that must be released.
struct Owned<T> {
    it: NonNull<T>,
    release: unsafe extern "C" fn(*const T),
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        // SAFETY: it came from assimp, has no other owner and is released once.
        unsafe { (self.release)(self.it.as_ptr()) }
    }
}

/// # Safety
/// The symbol must be a function of the type `T`, which must not outlive `code`.
unsafe fn symbol<T: Copy>(code: &libloading::Library, name: &CStr) -> Result<T, libloading::Error> {
    // SAFETY: promised by the caller.
    unsafe { code.get::<T>(name.to_bytes_with_nul()) }.map(|symbol| *symbol)
}

/// # Safety
/// `raw` must be null or point to a zero-terminated string.
unsafe fn text(raw: *const c_char) -> String {
    match raw.is_null() {
        true => String::new(),
        // SAFETY: promised by the caller.
        false => unsafe { CStr::from_ptr(raw) }.to_string_lossy().into_owned(),
    }
}

fn listed(names: &[OsString]) -> String {
    names.iter().map(|name| name.to_string_lossy()).collect::<Vec<_>>().join(", ")
}

fn missing(fault: &str) -> ExportError {
    ExportError::MissingPart {
        message: format!("target `assimp` needs libassimp, which {fault}"),
        hint: format!("`apt-get install libassimp5`, `brew install assimp`, or name the library in {PATH}"),
    }
}

#[cfg(test)]
mod tests {
    use std::mem::{offset_of, size_of};

    use super::*;

    #[test]
    fn structures_have_the_sizes_of_the_headers() {
        assert_eq!(size_of::<RawText>(), 4 + 1024);
        assert_eq!(offset_of!(RawBlob, name), 2 * size_of::<usize>());
        assert_eq!(size_of::<RawFormat>(), 3 * size_of::<usize>());
    }

    #[test]
    fn a_missing_library_is_reported_with_what_to_install() {
        let error = Library::open(&["/nowhere/libassimp.so".into()]).err().expect("there is no such file");
        assert_eq!(
            error.to_string(),
            "target `assimp` needs libassimp, which is not installed (looked for /nowhere/libassimp.so)"
        );
        assert!(error.hint().is_some_and(|hint| hint.contains("apt-get install libassimp5")) && !error.is_usage());
    }

    #[test]
    fn the_name_of_a_blob_is_read_by_its_length_and_a_blob_may_be_empty() {
        let mut data = [b'x' as c_char; 1024];
        data[..3].copy_from_slice(&b"mtl".map(|letter| letter as c_char));
        let name = RawText { length: 3, data };
        let blob = RawBlob { bytes: 0, data: std::ptr::null(), name, next: std::ptr::null() };
        // SAFETY: there are no bytes that could be released.
        let (name, bytes) = unsafe { blob.content() };
        assert_eq!((name.as_str(), bytes), ("mtl", &[][..]));
    }
}
