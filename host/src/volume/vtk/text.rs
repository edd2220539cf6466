//! Samples as decimal numbers with blanks between them.

use std::io::{self, BufRead};

use super::body::{Body, damaged};
use crate::volume::error::excerpt;
use crate::volume::input::Input;
use crate::volume::{ElementType, ReadError};

/// Longest number that is read; a float of 64 bits without exponent has about 330 characters.
const NUMBER_BYTES: usize = 512;

/// Numbers from a place in a file on.
pub(super) struct Text {
    input: Input,
    start: u64,
    element: ElementType,
    /// Whether the numbers are parts of 255, as colours are in legacy files.
    is_color: bool,
    /// Bytes of the samples read so far.
    at: u64,
    word: Vec<u8>,
}

impl Text {
    /// Numbers from byte `start` of the file on.
    pub(super) fn new(
        mut input: Input,
        start: u64,
        element: ElementType,
        is_color: bool,
    ) -> Result<Self, ReadError> {
        input.seek(start)?;
        Ok(Self { input, start, element, is_color, at: 0, word: Vec::new() })
    }

    fn next(&mut self, out: &mut [u8]) -> io::Result<()> {
        read_word(&mut self.input, &mut self.word)?;
        let text = str::from_utf8(&self.word).unwrap_or_default();
        let stored = match self.is_color {
            true => text.parse::<f32>().ok().map(|part| out.copy_from_slice(&[(part * 255.0).round() as u8])),
            false => store(text, self.element, out),
        };
        let found = || excerpt(&String::from_utf8_lossy(&self.word));
        stored.ok_or_else(|| invalid(format!("{} is no number of type {}", found(), self.element)))
    }
}

impl Body for Text {
    fn fill(&mut self, out: &mut [u8]) -> Result<(), ReadError> {
        for value in out.chunks_exact_mut(self.element.bytes()) {
            self.next(value).map_err(|cause| damaged(self.input.path(), cause))?;
        }
        self.at += out.len() as u64;
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<(), ReadError> {
        if position < self.at {
            self.input.seek(self.start)?;
            self.at = 0;
        }
        let count = (position - self.at) / self.element.bytes() as u64;
        skip_words(&mut self.input, count).map_err(|cause| damaged(self.input.path(), cause))?;
        self.at = position;
        Ok(())
    }

    fn is_random(&self) -> bool {
        false
    }
}

/// Passes over so many numbers or words.
pub(super) fn skip_words(input: &mut Input, count: u64) -> io::Result<()> {
    let mut word = Vec::new();
    (0..count).try_for_each(|_| read_word(input, &mut word))
}

/// Reads up to the blank or tag that ends a word; neither is consumed.
fn read_word(input: &mut Input, word: &mut Vec<u8>) -> io::Result<()> {
    word.clear();
    loop {
        let bytes = input.fill_buf()?;
        if bytes.is_empty() {
            break;
        }
        let blanks = match word.is_empty() {
            true => bytes.iter().take_while(|byte| byte.is_ascii_whitespace()).count(),
            false => 0,
        };
        let rest = &bytes[blanks..];
        let end = rest.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'<');
        let length = end.unwrap_or(rest.len());
        if word.len() + length > NUMBER_BYTES {
            return Err(invalid(format!("a number has more than {NUMBER_BYTES} characters")));
        }
        word.extend_from_slice(&rest[..length]);
        input.consume(blanks + length);
        if end.is_some() {
            break;
        }
    }
    match word.is_empty() {
        true => Err(io::ErrorKind::UnexpectedEof.into()),
        false => Ok(()),
    }
}

fn invalid(text: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, text)
}

/// Puts a number into the little-endian bytes of one sample.
fn store(text: &str, element: ElementType, out: &mut [u8]) -> Option<()> {
    macro_rules! parse {
        ($($element:ident $number:ty),*) => {
            match element {
                $(ElementType::$element => out.copy_from_slice(&text.parse::<$number>().ok()?.to_le_bytes()),)*
            }
        };
    }
    parse!(U8 u8, I8 i8, U16 u16, I16 i16, U32 u32, I32 i32, U64 u64, I64 i64, F32 f32, F64 f64);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &str, element: ElementType) -> Text {
        Text::new(Input::from_bytes(bytes.as_bytes()), 1, element, false).unwrap()
    }

    #[test]
    fn numbers_are_read_one_by_one_up_to_a_tag() {
        let mut numbers = text("x 1 -2\n\t300 -32768</a>", ElementType::I16);
        let mut out = [0; 8];
        numbers.fill(&mut out).unwrap();
        assert_eq!(out, [1, 0, 0xfe, 0xff, 0x2c, 1, 0, 0x80]);
        numbers.fill(&mut out[..2]).unwrap_err();
        numbers.seek(4).unwrap();
        numbers.fill(&mut out[..2]).unwrap();
        assert_eq!(out[..2], 300_i16.to_le_bytes());
        numbers.seek(2).unwrap();
        numbers.fill(&mut out[..2]).unwrap();
        assert_eq!(out[..2], (-2_i16).to_le_bytes());
    }

    #[test]
    fn what_is_no_number_of_the_type_is_told() {
        for (bytes, element) in
            [("x 256", ElementType::U8), ("x 1.5", ElementType::I32), ("x a", ElementType::F32)]
        {
            let error = text(bytes, element).fill(&mut [0; 8][..element.bytes()]).unwrap_err();
            assert!(error.to_string().contains("is no number of type"), "{error}");
        }
        let long = format!("x {}", "1".repeat(2000));
        let error = text(&long, ElementType::F64).fill(&mut [0; 8]).unwrap_err();
        assert!(error.to_string().contains("more than 512 characters"), "{error}");
        let mut float = [0; 4];
        text("xnan", ElementType::F32).fill(&mut float).unwrap();
        assert!(f32::from_le_bytes(float).is_nan());
    }
}
