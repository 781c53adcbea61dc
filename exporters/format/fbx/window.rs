//! A file writer optimised for many short backward seeks, such as for a length that precedes its data.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

/// Bytes kept in memory: most backward seeks stay within them.
const WINDOW_BYTES: usize = 1 << 20;

/// A file whose last bytes are in memory. A seek within them costs nothing, while a [`std::io::BufWriter`] would flush them
/// first; any other seek is one of the file.
pub struct Window {
    file: File,
    /// Offset of the buffered bytes in the file.
    start: u64,
    bytes: Vec<u8>,
    at: usize,
}

impl Window {
    /// An empty file.
    pub fn new(file: File) -> Self {
        Self { file, start: 0, bytes: Vec::new(), at: 0 }
    }

    /// Writes the buffered bytes, and continues after them.
    fn shift(&mut self) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.start))?;
        self.file.write_all(&self.bytes)?;
        self.start += self.bytes.len() as u64;
        self.bytes.clear();
        self.at = 0;
        Ok(())
    }
}

impl Write for Window {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let over = buffer.len().min(self.bytes.len() - self.at);
        self.bytes[self.at..self.at + over].copy_from_slice(&buffer[..over]);
        self.bytes.extend_from_slice(&buffer[over..]);
        self.at += buffer.len();
        if self.bytes.len() > WINDOW_BYTES && self.at == self.bytes.len() {
            self.shift()?;
        }
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let at = self.stream_position()?;
        self.shift()?;
        self.start = at;
        Ok(())
    }
}

impl Seek for Window {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let to = match to {
            SeekFrom::Start(to) => to,
            SeekFrom::Current(by) => self.stream_position()?.saturating_add_signed(by),
            SeekFrom::End(by) => {
                self.shift()?;
                self.file.seek(SeekFrom::End(by))?
            }
        };
        match to.checked_sub(self.start) {
            Some(at) if at <= self.bytes.len() as u64 => self.at = at as usize,
            _ => {
                self.shift()?;
                self.start = to;
            }
        }
        Ok(to)
    }

    fn stream_position(&mut self) -> io::Result<u64> {
        Ok(self.start + self.at as u64)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Read};

    use super::*;

    /// Seeks of all lengths give the same bytes as an in-memory file.
    #[test]
    fn a_window_writes_the_same_as_an_in_memory_file() {
        let mut expected = Cursor::new(Vec::new());
        let mut window = Window::new(tempfile::tempfile().unwrap());
        let mut noise = 1_u32;
        for step in 0..4000_u32 {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let bytes = vec![step as u8; (noise >> 20) as usize];
            for sink in [&mut expected as &mut dyn Sink, &mut window] {
                sink.write_all(&bytes).unwrap();
                let end = sink.stream_position().unwrap();
                sink.seek(SeekFrom::Start(end * u64::from(noise >> 16 & 255) / 255)).unwrap();
                step.to_le_bytes().chunks(2).for_each(|half| sink.write_all(half).unwrap());
                assert_eq!(sink.seek(SeekFrom::End(0)).unwrap(), sink.stream_position().unwrap());
            }
        }
        window.flush().unwrap();
        let mut written = Vec::new();
        window.file.seek(SeekFrom::Start(0)).unwrap();
        window.file.read_to_end(&mut written).unwrap();
        assert!(written.len() > 4 * WINDOW_BYTES && written == expected.into_inner());
    }

    trait Sink: Write + Seek {}

    impl<T: Write + Seek> Sink for T {}
}
