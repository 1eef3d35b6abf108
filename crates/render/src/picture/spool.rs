//! Radiance that waits until the exposure of its picture is known.

use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;
use tempfile::SpooledTempFile;

/// Bytes that are kept in memory; more go to a file without a name, which vanishes with the program.
const MEMORY: usize = 64 << 20;
const PIXEL: usize = 12;

/// Pixels in the order in which they came, 12 bytes each.
pub(super) struct RadianceSpool {
    writer: BufWriter<SpooledTempFile>,
    pixels: u64,
}

impl RadianceSpool {
    /// An empty spool whose file, if it needs one, is in the folder of `path`: where the picture will need space, too.
    pub(super) fn beside(path: &Path) -> io::Result<Self> {
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let file = tempfile::spooled_tempfile_in(MEMORY, directory.unwrap_or(Path::new(".")));
        Ok(RadianceSpool { writer: BufWriter::with_capacity(1 << 18, file), pixels: 0 })
    }

    pub(super) fn push(&mut self, radiance: [f32; 3]) -> io::Result<()> {
        self.pixels += 1;
        self.writer.write_all(bytemuck::cast_slice(&radiance))
    }

    /// Shows all pixels again.
    pub(super) fn replay(&mut self, see: &mut dyn FnMut([f32; 3]) -> io::Result<()>) -> io::Result<()> {
        self.writer.flush()?;
        let file = self.writer.get_mut();
        file.seek(SeekFrom::Start(0))?;
        let mut reader = BufReader::with_capacity(1 << 18, &mut *file);
        let mut bytes = [0; PIXEL];
        for _ in 0..self.pixels {
            reader.read_exact(&mut bytes)?;
            see(bytemuck::pod_read_unaligned(&bytes))?;
        }
        // More may follow.
        file.seek(SeekFrom::End(0))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_back_as_often_as_wanted() {
        let directory = tempfile::tempdir().unwrap();
        let mut spool = RadianceSpool::beside(&directory.path().join("a.png")).unwrap();
        // Forces it to disk.
        spool.writer.get_mut().roll().unwrap();
        for i in 0..1000 {
            spool.push([i as f32, -1.0, 0.5]).unwrap();
        }
        for _ in 0..2 {
            let mut seen = Vec::new();
            spool
                .replay(&mut |pixel| {
                    seen.push(pixel[0]);
                    Ok(())
                })
                .unwrap();
            assert!(seen.len() == 1000 && seen[999] == 999.0);
        }
        drop(spool);
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}
