//! Files with all chunks of a scene or one each, for formats that allow both.
//!
//! A format may need values at the start of a file that are known only at its end, and several files may be written at the
//! same time, while a [`Package`] allows one open file. So they are written in a scratch folder and copied when complete:
//! each chunk is loaded once.

use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::error::{ExportError, at};
use crate::package::Package;
use crate::scene::{Chunk, Scene};

/// Triangles written: visual and collision.
pub(crate) type Triangles = [u64; 2];

/// Files that belong together and share a stem.
pub(crate) trait ChunkFiles: Sized {
    /// Adds a chunk, which is number `index` of the scene.
    fn add(
        &mut self,
        scene: &Scene,
        index: usize,
        chunk: &Chunk,
        out: &mut dyn Package,
    ) -> Result<Triangles, ExportError>;

    /// Copies the files into the package.
    fn finish(self, out: &mut dyn Package) -> Result<(), ExportError>;
}

/// Writes one chunk_files at the stem `<scene>`, or one per chunk at `chunks/<chunk>`.
pub(crate) fn write<S: ChunkFiles>(
    scene: &Scene,
    per_chunk: bool,
    out: &mut dyn Package,
    start: impl Fn(Stem) -> Result<S, ExportError>,
) -> Result<Triangles, ExportError> {
    let scratch = out.scratch()?;
    let (mut triangles, mut unfinished) = ([0, 0], None);
    for index in 0..scene.chunks.len() {
        let chunk = scene.chunk(index)?;
        let (folder, name) = if per_chunk { ("chunks/", &chunk.name) } else { ("", &scene.name) };
        let mut chunk_files: S = match unfinished.take() {
            Some(chunk_files) => chunk_files,
            None => start(Stem { folder, name: name.clone(), scratch: scratch.path().to_owned() })?,
        };
        let added = chunk_files.add(scene, index, &chunk, out)?;
        triangles = [0, 1].map(|part| triangles[part] + added[part]);
        unfinished = Some(chunk_files);
        if per_chunk {
            unfinished.take().map_or(Ok(()), |chunk_files| chunk_files.finish(out))?;
        }
    }
    unfinished.map_or(Ok(()), |chunk_files| chunk_files.finish(out))?;
    Ok(triangles)
}

/// How to open the files with this extension.
pub(crate) fn how_to_open(scene: &Scene, per_chunk: bool, extension: &str) -> String {
    match per_chunk {
        true => "open the files of chunks/ together".to_owned(),
        false => format!("open {}.{extension}", scene.name),
    }
}

/// Names of files that belong together, and their scratch folder.
#[derive(Clone)]
pub(crate) struct Stem {
    /// Their folder in the package: empty, or with a trailing slash.
    pub folder: &'static str,
    /// The stem of their names.
    pub name: String,
    scratch: PathBuf,
}

impl Stem {
    /// A stem of names in the folder of the package itself.
    pub fn new(name: &str, scratch: &Path) -> Self {
        Self { folder: "", name: name.to_owned(), scratch: scratch.to_owned() }
    }

    /// An empty file named by the stem and `ending`.
    pub fn grow(&self, ending: &str) -> Result<TempFile, ExportError> {
        let file = format!("{}{ending}", self.name);
        TempFile::create(self.scratch.join(&file), format!("{}{file}", self.folder))
    }

    /// A file with this name that starts as a copy of `model`.
    pub fn grow_from(&self, model: &mut TempFile, ending: &str) -> Result<TempFile, ExportError> {
        model.flush()?;
        let mut copy = self.grow(ending)?;
        io::copy(&mut model.reopen()?, &mut copy)?;
        Ok(copy)
    }
}

/// A file in the scratch folder. Its errors name the file of the package.
pub(crate) struct TempFile {
    place: PathBuf,
    path: String,
    file: BufWriter<File>,
}

impl TempFile {
    fn create(place: PathBuf, path: String) -> Result<Self, ExportError> {
        let file = File::create_new(&place).map_err(|error| at(&path, &error))?;
        Ok(Self { place, path, file: BufWriter::with_capacity(1 << 16, file) })
    }

    /// A reader of what has been written so far.
    pub fn reader(&mut self) -> io::Result<BufReader<File>> {
        self.flush()?;
        Ok(BufReader::new(self.reopen()?))
    }

    /// A reader of what has been flushed.
    fn reopen(&self) -> io::Result<File> {
        File::open(&self.place).map_err(|error| at(&self.path, &error))
    }

    /// Path in the package.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Appends the content to `out`.
    pub fn append_to(mut self, out: &mut dyn Write) -> Result<(), ExportError> {
        self.flush()?;
        io::copy(&mut self.reopen()?, out)?;
        Ok(fs::remove_file(self.place)?)
    }

    /// Copies it into the package.
    pub fn finish(self, out: &mut dyn Package) -> Result<(), ExportError> {
        let path = self.path.clone();
        out.write(&path, |file| self.append_to(file))
    }
}

impl Write for TempFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.file.write(buffer).map_err(|error| at(&self.path, &error))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush().map_err(|error| at(&self.path, &error))
    }
}
