//! Archives in the ZIP format, whose files are stored without compression.

use crate::Stop;

/// ZIP archive under construction.
#[derive(Default)]
pub struct Archive {
    /// Bytes of the headers and contents of the files written so far.
    contents: Vec<u8>,
    /// Central directory of the archive, which is written after the files.
    directory: Vec<u8>,
    count: u16,
}

/// Version of the ZIP format that uncompressed files need.
const VERSION: u16 = 20;
/// Flag of a file entry whose name is in UTF-8.
const UTF_8: u16 = 1 << 11;
/// Date of all files: the first day that the format has, so that equal contents give equal archives.
const DATE: u16 = (1 << 5) | 1;

impl Archive {
    /// Adds a file to the archive without compression.
    ///
    /// # Errors
    /// The file or the archive is too large for the format.
    pub fn add_file(&mut self, path: &str, bytes: &[u8]) -> Result<(), Stop> {
        let archive_size_error = |_| Stop::Failure(format!("`{path}` is too large for an archive"));
        let size = u32::try_from(bytes.len()).map_err(archive_size_error)?;
        let offset = u32::try_from(self.contents.len()).map_err(archive_size_error)?;
        let length = u16::try_from(path.len()).map_err(archive_size_error)?;
        // Both headers have version, flags, method, time, date, checksum and sizes.
        let mut shared = Vec::new();
        [VERSION, UTF_8, 0, 0, DATE].iter().for_each(|x| shared.extend(x.to_le_bytes()));
        [crc32_checksum(bytes), size, size].iter().for_each(|x| shared.extend(x.to_le_bytes()));
        [length, 0].iter().for_each(|x| shared.extend(x.to_le_bytes()));
        self.contents.extend(*b"PK\x03\x04");
        self.contents.extend(&shared);
        self.contents.extend(path.bytes());
        self.contents.extend(bytes);
        self.directory.extend(*b"PK\x01\x02");
        self.directory.extend(VERSION.to_le_bytes());
        self.directory.extend(&shared);
        // No comment, first disk, no attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(path.bytes());
        self.count += 1;
        Ok(())
    }

    /// Returns the bytes of the archive.
    pub fn archive_bytes(self) -> Vec<u8> {
        let start = self.contents.len() as u32;
        let size = self.directory.len() as u32;
        let mut bytes = self.contents;
        bytes.extend(self.directory);
        bytes.extend(*b"PK\x05\x06");
        [0, 0, self.count, self.count].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        [size, start].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend([0; 2]);
        bytes
    }
}

/// Returns the cyclic redundancy check CRC-32 of the ZIP format.
fn crc32_checksum(bytes: &[u8]) -> u32 {
    let advance_crc_by_bit = |sum: u32| if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 };
    !bytes.iter().fold(!0, |sum, byte| (0..8).fold(sum ^ u32::from(*byte), |sum, _| advance_crc_by_bit(sum)))
}

#[cfg(test)]
mod tests {
    /// Checks the checksum against the published check value of CRC-32.
    #[test]
    fn crc32_has_the_published_check_value() {
        assert_eq!(super::crc32_checksum(b"123456789"), 0xcbf4_3926);
    }
}
