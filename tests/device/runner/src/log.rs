//! The firmware's log: defmt frames, whose texts are in its ELF file.

use std::collections::BTreeMap;

use defmt_decoder::{DecodeError, Table};

/// A decoded log.
pub(crate) struct Log {
    pub(crate) lines: Vec<String>,
}

impl Log {
    pub(crate) fn decode(elf: &[u8], frames: &[u8]) -> Result<Self, String> {
        let table = Table::parse(elf).map_err(|error| format!("the firmware's texts: {error}"))?;
        let table = table.ok_or("the firmware has no texts of defmt")?;
        let mut decoder = table.new_stream_decoder();
        decoder.received(frames);
        let mut lines = vec![];
        loop {
            match decoder.decode() {
                Ok(frame) => lines.push(frame.display_message().to_string()),
                Err(DecodeError::UnexpectedEof) => return Ok(Self { lines }),
                Err(DecodeError::Malformed) => {
                    return Err(format!("log line {} is malformed", lines.len() + 1));
                }
            }
        }
    }

    /// The `key=value` pairs of every line that begins with `word`.
    pub(crate) fn records<'a>(&'a self, word: &'a str) -> impl Iterator<Item = BTreeMap<&'a str, &'a str>> {
        let of_word = self.lines.iter().filter_map(move |line| line.strip_prefix(word)?.strip_prefix(' '));
        of_word.map(|rest| rest.split(' ').filter_map(|pair| pair.split_once('=')).collect())
    }
}
