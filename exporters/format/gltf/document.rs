//! The JSON of a document, of which the lists that grow with every thing are on the disk.

use std::path::Path;

use gltf_json::buffer::View;
use gltf_json::{Accessor, Mesh, Node, Root};
use serde::Serialize;

use super::spool::Spool;
use crate::error::{ExportError, at};

/// A document: a [`Root`] whose longest lists are beside it.
#[derive(Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Document {
    /// All the rest.
    #[serde(flatten)]
    pub(super) root: Root,
    #[serde(skip_serializing_if = "Spool::is_empty")]
    pub(super) accessors: Spool<Accessor>,
    #[serde(skip_serializing_if = "Spool::is_empty")]
    pub(super) buffer_views: Spool<View>,
    #[serde(skip_serializing_if = "Spool::is_empty")]
    pub(super) meshes: Spool<Mesh>,
    #[serde(skip_serializing_if = "Spool::is_empty")]
    pub(super) nodes: Spool<Node>,
}

impl Document {
    /// Bytes of the first buffer, which the payload of a GLB is.
    pub(super) fn payload_bytes(&self) -> u64 {
        self.root.buffers.first().map_or(0, |buffer| buffer.byte_length.0)
    }

    /// Lets go of what will not change any more.
    ///
    /// # Errors
    /// Those of files in the folder `scratch`.
    pub(super) fn settle(&mut self, scratch: &Path) -> Result<(), ExportError> {
        let named = |error| at(scratch.display(), &error);
        self.accessors.settle(scratch).map_err(named)?;
        self.buffer_views.settle(scratch).map_err(named)?;
        self.meshes.settle(scratch).map_err(named)?;
        Ok(self.nodes.settle(scratch).map_err(named)?)
    }
}
