//! A row of samples and its halves: copies from one to the other.

use crate::memory::copy;

/// Pairs of samples that are composed before they are stored, so that it is done in vectors.
const RUN: usize = 8;

/// Samples along x, and memory for their halves: ceil(n/2) scaling and floor(n/2) wavelet coefficients.
#[derive(Debug)]
pub(super) struct Row<'a> {
    pub(super) samples: &'a mut [i32],
    pub(super) low: &'a mut [i32],
    pub(super) high: &'a mut [i32],
}

/// x\[0\], x\[2\], … to `low`, x\[1\], x\[3\], … to `high`.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn separate(row: Row<'_>) {
    let (pairs, odd) = row.samples.as_chunks::<2>();
    if let (&[last], Some(c)) = (odd, row.low.last_mut()) {
        *c = last;
    }
    for ((&[even, odd], c), d) in pairs.iter().zip(row.low).zip(row.high) {
        (*c, *d) = (even, odd);
    }
}

/// Undoes [`separate`].
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn interleave(row: Row<'_>) {
    let (pairs, odd) = row.samples.as_chunks_mut::<2>();
    if let ([last], Some(&mut c)) = (odd, row.low.last_mut()) {
        *last = c;
    }
    let low = row.low.get(..pairs.len()).unwrap_or_default();
    let ((runs, pairs), (lows, low), (highs, high)) =
        (pairs.as_chunks_mut::<RUN>(), low.as_chunks::<RUN>(), row.high.as_chunks::<RUN>());
    for ((run, &low), &high) in runs.iter_mut().zip(lows).zip(highs) {
        let mut composed = [[0; 2]; RUN];
        for ((pair, c), d) in composed.iter_mut().zip(low).zip(high) {
            *pair = [c, d];
        }
        *run = composed;
    }
    for ((pair, &c), &d) in pairs.iter_mut().zip(low).zip(high) {
        *pair = [c, d];
    }
}

/// Both halves to the samples, one after the other.
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn join(row: Row<'_>) {
    let (low, high) = row.samples.split_at_mut_checked(row.low.len()).unwrap_or_default();
    copy(row.low, low);
    copy(row.high, high);
}

/// Undoes [`join`].
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn divide(row: Row<'_>) {
    let (low, high) = row.samples.split_at_checked(row.low.len()).unwrap_or_default();
    copy(low, row.low);
    copy(high, row.high);
}
