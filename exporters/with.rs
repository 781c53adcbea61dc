//! Packages inside a package: ground truth beside the files of a simulator.

use std::io::{self, Write};

use tempfile::TempDir;

use crate::bundle::Bundle;
use crate::error::ExportError;
use crate::frame::Axes;
use crate::package::{Files, Package};
use crate::scene::Scene;
use crate::target::{Summary, Target};

/// A target whose package holds those of others, each in a folder of its own.
pub struct With {
    /// Whose package it is.
    pub target: Box<dyn Target>,
    /// The others by folder.
    pub inside: Vec<(String, Box<dyn Target>)>,
}

impl Target for With {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        let summary = self.target.export(scene, out)?;
        for (folder, target) in &self.inside {
            let mut below = Below { out, folder, files: Files::default() };
            target.export(scene, &mut below)?;
            below.finish();
        }
        Ok(summary)
    }

    fn axes(&self) -> Axes {
        self.target.axes()
    }

    fn references(&self) -> &'static [&'static str] {
        self.target.references()
    }

    fn wants_pieces(&self) -> bool {
        self.target.wants_pieces() || self.inside.iter().any(|(_, target)| target.wants_pieces())
    }

    fn moves_things(&self) -> bool {
        self.target.moves_things()
    }
}

/// A folder of a package.
struct Below<'a> {
    out: &'a mut dyn Package,
    folder: &'a str,
    files: Files,
}

impl Below<'_> {
    /// Lists its files among those of the package.
    fn finish(self) {
        let listed = self.files.0.into_iter().map(|(path, entry)| (format!("{}/{path}", self.folder), entry));
        self.out.files().0.extend(listed);
    }
}

impl Package for Below<'_> {
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>> {
        self.out.open(&format!("{}/{path}", self.folder))
    }

    fn close(&mut self) -> io::Result<()> {
        self.out.close()
    }

    fn scratch(&mut self) -> io::Result<TempDir> {
        self.out.scratch()
    }

    fn files(&mut self) -> &mut Files {
        &mut self.files
    }

    fn bundle(&self) -> Option<Bundle> {
        self.out.bundle()
    }
}
