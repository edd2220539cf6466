//! Rivals that are programs of their own.

use std::str::FromStr;

use super::record::{Coding, Refused, Row};
use super::volumes::Listed;
use crate::shell::output;

/// `NAME=PROGRAM`: a codec, and a program that measures it.
///
/// `PROGRAM FILE X Y Z TYPE` codes a raw file without loss, checks that it comes back, and prints the bytes, and the
/// seconds of encoding and of decoding, with a blank between.
#[derive(Clone)]
pub(super) struct Rival {
    codec: String,
    program: String,
}

impl FromStr for Rival {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (codec, program) = text.split_once('=').ok_or("not NAME=PROGRAM")?;
        Ok(Self { codec: codec.to_owned(), program: program.to_owned() })
    }
}

impl Rival {
    /// A row for a volume: what the program printed, or that it printed nothing of use.
    pub(super) fn measure(&self, volume: &Listed) -> Row {
        let extent = volume.extent.map(|axis| axis.to_string());
        let [x, y, z] = extent.each_ref().map(String::as_str);
        let printed = output(&self.program, &[&volume.path, x, y, z, &volume.element]);
        match printed.as_deref().map(parse) {
            Ok(Some((bytes, encode_seconds, decode_seconds))) => Row::Coding(Coding {
                volume: volume.name.clone(),
                task: volume.task().to_owned(),
                codec: self.codec.clone(),
                bytes,
                encode_seconds,
                decode_seconds,
                encode_memory: None,
                decode_memory: None,
                right: true,
            }),
            other => {
                eprintln!("{}: {other:?}", self.program);
                let why = "its program fails".to_owned();
                Row::Refused(Refused { volume: volume.name.clone(), codec: self.codec.clone(), why })
            }
        }
    }
}

/// Bytes and two times.
fn parse(text: &str) -> Option<(u64, f64, f64)> {
    let mut figures = text.split_whitespace();
    let mut next = || figures.next();
    Some((next()?.parse().ok()?, next()?.parse().ok()?, next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_read_and_anything_else_is_not() {
        assert_eq!(parse("1234 0.5 0.25\n"), Some((1234, 0.5, 0.25)));
        assert_eq!(parse("1234 0.5"), None);
        assert_eq!(parse("error"), None);
        assert!("name".parse::<Rival>().is_err());
    }

    #[test]
    fn a_program_that_is_missing_refuses() {
        let rival: Rival = "name=no-such-program".parse().unwrap();
        let record = super::super::example();
        let Row::Refused(row) = rival.measure(&record.volumes[0]) else { panic!("no such program") };
        assert_eq!((row.codec.as_str(), row.volume.as_str()), ("name", "one"));
    }
}
