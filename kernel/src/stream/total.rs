//! The parsers of the headers of streams are total.

use super::{RowPlan, SlabPlan};
use crate::DecodeError;
use crate::total::{Written, follow};

fn rows(bytes: &[u8]) -> Result<Written, DecodeError> {
    let (plan, len) = RowPlan::parse(bytes)?;
    assert_eq!(len, plan.header().len());
    Ok(Written::from_slice(&plan.header()).unwrap())
}

fn slabs(bytes: &[u8]) -> Result<Written, DecodeError> {
    let (plan, len) = SlabPlan::parse(bytes)?;
    assert_eq!(len, plan.header().len());
    Ok(Written::from_slice(&plan.header()).unwrap())
}

#[test]
#[cfg_attr(miri, ignore = "many values through code without addresses")]
fn every_beginning_is_settled_and_what_is_read_is_written_again() {
    for parse in [rows, slabs] {
        let [settled, headers] = follow(parse);
        // Five wrong bytes settle it: 255 each for the first four, and what is no type or wavelet.
        assert!(settled > 4 * 255 + 256 - 42, "{settled} beginnings");
        assert!(headers > 1000, "{headers} headers of {settled} beginnings");
    }
}
