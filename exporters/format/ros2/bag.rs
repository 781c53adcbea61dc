//! A file of messages, as `ros2 bag` records and Foxglove shows them.
//!
//! Follows the MCAP specification (crate `mcap`) and its profile `ros2`, in chunks compressed by Zstandard.

use std::collections::BTreeMap;
use std::io::{self, Seek, Write};

use mcap::records::MessageHeader;
use mcap::{Compression, McapError, WriteOptions, Writer};

use super::Kind;

/// A bag that grows.
pub struct Bag<W: Write + Seek> {
    writer: Writer<W>,
    /// Number of the channel and of its last message, by topic.
    channels: BTreeMap<String, (u16, u32)>,
}

/// A message and where it goes.
pub struct Message {
    /// Its topic.
    pub topic: String,
    /// What it is.
    pub kind: &'static Kind,
    /// When it was sent, in nanoseconds.
    pub time_ns: i64,
    /// Its encoding.
    pub data: Vec<u8>,
    /// Whether those who come late get it too.
    pub is_latched: bool,
}

impl<W: Write + Seek> Bag<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// Those of writing.
    pub fn create(file: W) -> io::Result<Self> {
        let options = WriteOptions::new().profile("ros2").library("plume").compression(Some(Compression::Zstd));
        let writer = options.compression_level(3).create(file).map_err(failed)?;
        Ok(Self { writer, channels: BTreeMap::new() })
    }

    /// Appends a message.
    ///
    /// # Errors
    /// Those of writing.
    pub fn write(&mut self, message: Message) -> io::Result<()> {
        let Message { topic, kind, time_ns, data, is_latched } = message;
        let (channel, sequence) = match self.channels.get_mut(&topic) {
            Some(known) => known,
            None => {
                let definition = kind.definition();
                let schema = self.writer.add_schema(kind.name, "ros2msg", definition.as_bytes()).map_err(failed)?;
                let profiles = profiles(is_latched);
                let channel = self.writer.add_channel(schema, &topic, "cdr", &profiles).map_err(failed)?;
                self.channels.entry(topic).or_insert((channel, 0))
            }
        };
        let time = u64::try_from(time_ns).unwrap_or_default();
        let header = MessageHeader { channel_id: *channel, sequence: *sequence, log_time: time, publish_time: time };
        *sequence += 1;
        self.writer.write_to_known_channel(&header, &data).map_err(failed)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of writing.
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.finish().map(drop).map_err(failed)
    }
}

/// How `ros2 bag play` offers a topic.
fn profiles(is_latched: bool) -> BTreeMap<String, String> {
    let durability = if is_latched { 1 } else { 2 };
    let text = format!(
        "- history: 1\n  depth: 10\n  reliability: 1\n  durability: {durability}\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  \
         lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    \
         nsec: 854775807\n  avoid_ros_namespace_conventions: false"
    );
    BTreeMap::from([("offered_qos_profiles".to_owned(), text)])
}

fn failed(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
