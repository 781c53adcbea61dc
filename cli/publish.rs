//! `plume publish`: a finished dataset elsewhere.

use std::num::NonZero;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::Host;
use super::fault::CliError;
use super::progress::Console;

/// Copies a finished dataset to an object store or another folder, as it is or as WebDataset shards. Every file is checked against
/// its SHA-256 on the way. If interrupted, the same command copies what is missing; shards are written anew.
#[derive(Args)]
pub struct Publish {
    /// The folder of the dataset
    #[arg(value_name = "DIR")]
    pub dataset: PathBuf,
    /// Where to: a folder, or a URL of fsspec, such as `s3://BUCKET/PATH`
    #[arg(value_name = "URL")]
    pub url: String,
    /// Write WebDataset shards (TAR archives, by train, validation and test) of up to N caves each
    #[arg(long, value_name = "N")]
    pub shards: Option<NonZero<u32>>,
}

impl Publish {
    /// Publishes by the Python package.
    ///
    /// # Errors
    /// No finished dataset, files that were changed since, a store that refuses.
    pub fn run(&self, console: &Console, host: &Host) -> Result<(), CliError> {
        let Host::Python { publish, .. } = host else { unreachable!("the binary hands over to Python") };
        let files = publish(self)?;
        if console.is_json() {
            return console.result(&format!("{:#}\n", json!({"url": self.url, "files": files})));
        }
        let kind = if self.shards.is_some() { "shards" } else { "files written" };
        console.note(&format!("  published {}  {files} {kind}", self.url));
        Ok(())
    }
}
