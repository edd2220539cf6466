//! The Python literal in a `.npy` header: one dictionary of text, truth values and tuples of numbers.

use super::NpyError;
use crate::volume::error::excerpt;

/// The three entries of the dictionary, in whatever order they stood.
#[derive(Debug, PartialEq)]
pub(super) struct Entries {
    pub(super) descr: String,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<u64>,
}

impl Entries {
    /// Reads `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }`, with any blanks, any order, with or
    /// without the last commas, and with the `L` that Python 2 put behind numbers.
    pub(super) fn parse(text: &str) -> Result<Self, NpyError> {
        Scanner { rest: text }.dictionary().ok_or_else(|| {
            // A list in the place of the type means records; this is worth a message of its own.
            let is_record = text.contains('[');
            if is_record { NpyError::Records } else { NpyError::Header { text: excerpt(text.trim_end()) } }
        })
    }
}

struct Scanner<'a> {
    rest: &'a str,
}

impl<'a> Scanner<'a> {
    fn dictionary(mut self) -> Option<Entries> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        self.expect('{')?;
        while !self.eat('}') {
            let key = self.text()?;
            self.expect(':')?;
            let is_new = match key {
                "descr" => descr.replace(self.text()?).is_none(),
                "fortran_order" => fortran_order.replace(self.truth()?).is_none(),
                "shape" => shape.replace(self.tuple()?).is_none(),
                _ => false,
            };
            let goes_on = self.eat(',');
            if !is_new || !(goes_on || self.rest.starts_with('}')) {
                return None;
            }
        }
        let at_end = self.rest.trim_ascii().is_empty();
        let entries = Entries { descr: descr?.to_owned(), fortran_order: fortran_order?, shape: shape? };
        at_end.then_some(entries)
    }

    /// Passes over blanks, then over `wanted` if it comes next.
    fn eat(&mut self, wanted: char) -> bool {
        self.rest = self.rest.trim_ascii_start();
        match self.rest.strip_prefix(wanted) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, wanted: char) -> Option<()> {
        self.eat(wanted).then_some(())
    }

    /// Text in single or double quotes, without escapes: none of the three entries needs any.
    fn text(&mut self) -> Option<&'a str> {
        let quote = if self.eat('\'') { '\'' } else { self.eat('"').then_some('"')? };
        let (text, rest) = self.rest.split_once(quote)?;
        self.rest = rest;
        (!text.contains('\\')).then_some(text)
    }

    fn truth(&mut self) -> Option<bool> {
        self.rest = self.rest.trim_ascii_start();
        let (value, rest) = match self.rest.strip_prefix("True") {
            Some(rest) => (true, rest),
            None => (false, self.rest.strip_prefix("False")?),
        };
        self.rest = rest;
        Some(value)
    }

    fn tuple(&mut self) -> Option<Vec<u64>> {
        self.expect('(')?;
        let mut numbers = Vec::new();
        while !self.eat(')') {
            let digits = self.rest.bytes().take_while(u8::is_ascii_digit).count();
            let (number, rest) = self.rest.split_at(digits);
            numbers.push(number.parse().ok()?);
            self.rest = rest.strip_prefix('L').unwrap_or(rest);
            // Python takes `(5)` for a number: the comma of a single one must be there.
            let may_end = self.eat(',') || (numbers.len() > 1 && self.rest.starts_with(')'));
            if !may_end {
                return None;
            }
        }
        Some(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Option<(String, bool, Vec<u64>)> {
        let entries = Entries::parse(text).ok()?;
        Some((entries.descr, entries.fortran_order, entries.shape))
    }

    #[test]
    fn spacing_order_and_commas_do_not_matter() {
        let expected = Some(("<f4".to_owned(), false, vec![93, 64, 32]));
        for text in [
            "{'descr': '<f4', 'fortran_order': False, 'shape': (93, 64, 32), }          \n",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (93, 64, 32)}",
            "{\"shape\":(93,64,32,),\"descr\":\"<f4\",\"fortran_order\":False}\n",
            " {\n'fortran_order' : False ,\t'shape' : ( 93L , 64L , 32L ) , 'descr' : '<f4' } ",
        ] {
            assert_eq!(parse(text), expected, "{text}");
        }
        let text = "{'descr': '|u1', 'fortran_order': True, 'shape': (), }";
        assert_eq!(parse(text), Some(("|u1".to_owned(), true, vec![])));
        let text = "{'descr': '|u1', 'fortran_order': True, 'shape': (5,), }";
        assert_eq!(parse(text), Some(("|u1".to_owned(), true, vec![5])));
    }

    #[test]
    fn what_python_would_refuse_is_refused() {
        for text in [
            "",
            "{",
            "{}",
            "{'descr': '<f4', 'fortran_order': False}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (5)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (5,,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (5 6)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (-5,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,)}",
            "{'descr': '<f4', 'fortran_order': false, 'shape': (5,)}",
            "{'descr': '<f4', 'fortran_order': 0, 'shape': (5,)}",
            "{'descr': '<f4' 'fortran_order': False, 'shape': (5,)}",
            "{'descr': '<f4\", 'fortran_order': False, 'shape': (5,)}",
            "{'descr': '\\x3cf4', 'fortran_order': False, 'shape': (5,)}",
            "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (5,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (5,), 'more': 1}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (5,)} x",
        ] {
            assert_eq!(Entries::parse(text), Err(NpyError::Header { text: excerpt(text) }), "{text}");
        }
    }
}
