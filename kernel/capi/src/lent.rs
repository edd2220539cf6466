//! Memory lent by C: pointers and lengths become slices here, checked as far as pointers can be.
//!
//! Whether a pointer is to as much memory as its length says, nobody can check: that is the caller's promise, and the
//! contract of every call.

use core::marker::PhantomData;
use core::ops::Range;
use core::slice;

use crate::WaveliftError;
#[cfg(feature = "rows")]
use crate::state::Session;
use crate::state::State;

/// Samples and scratch: `wavelift_lent`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct WaveliftLent {
    /// Samples, x fastest.
    pub samples: *mut i32,
    /// Elements of `samples`: exactly as many as the call takes.
    pub samples_len: usize,
    /// Working memory; its contents have no meaning, before and after.
    pub scratch: *mut i32,
    /// Elements of `scratch`: at least as many as the call takes.
    pub scratch_len: usize,
}

/// Types of which every pattern of bits is a value.
///
/// # Safety
/// There is no pattern that is not a value, and no padding.
pub(crate) unsafe trait Plain {}

// SAFETY: every pattern of bits is a value.
unsafe impl Plain for u8 {}
// SAFETY: every pattern of bits is a value.
unsafe impl Plain for i32 {}
// SAFETY: every pattern of bits is a value.
unsafe impl Plain for usize {}

/// Buffers of one call, and of the one that began what it goes on with, at most.
const MOST: usize = 9;

/// Addresses of buffers, no two of which overlap.
#[derive(Clone, Debug)]
struct Ranges {
    /// Those not yet lent are empty.
    lent: [Range<usize>; MOST],
    count: usize,
}

/// Memory for one value, which may hold none yet. Only [`Loan::place`] makes it.
pub(crate) struct Place<'a, T> {
    at: *mut T,
    lender: PhantomData<&'a mut T>,
}

impl<T: Copy> Place<'_, T> {
    /// Writes the value.
    pub(crate) fn put(self, value: T) {
        // SAFETY: neither NULL nor misaligned, so that it is writable, by the promise of `Loan::new`.
        unsafe { self.at.write(value) };
    }
}

/// What one call was lent so far.
pub(crate) struct Loan<'a> {
    ranges: Ranges,
    lender: PhantomData<&'a mut u8>,
}

/// What lies in memory that was lent for many calls, from the first to the last.
#[cfg(feature = "rows")]
#[derive(Debug)]
#[repr(C)]
pub(crate) struct Begun<T> {
    /// [`Session::MARK`].
    mark: u64,
    /// What the first call was lent, this memory too.
    ranges: Ranges,
    value: T,
}

impl<'a> Loan<'a> {
    /// The loan of one call from C.
    ///
    /// # Safety
    /// Each pointer that the functions of this loan are given is NULL, or misaligned, or to as many elements of its
    /// type as it is given with, or to one. As long as `'a` these can be read, and written through a `*mut`, and
    /// nobody else writes to them.
    pub(crate) const unsafe fn new() -> Self {
        Self { ranges: Ranges { lent: [const { 0..0 }; MOST], count: 0 }, lender: PhantomData }
    }

    /// A copy of what `at` points to.
    pub(crate) fn copy<T: Copy>(&self, at: *const T) -> Result<T, WaveliftError> {
        address(at)?;
        // SAFETY: neither NULL nor misaligned, so that it points to a value that C wrote, by the promise of `new`.
        Ok(unsafe { at.read() })
    }

    /// Elements to read; NULL is allowed where there are none.
    pub(crate) fn read<T: Plain>(&mut self, at: *const T, len: usize) -> Result<&'a [T], WaveliftError> {
        if len == 0 {
            return Ok(&[]);
        }
        self.take(at, len)?;
        // SAFETY: neither NULL nor misaligned, so that it points to `len` elements, by the promise of `new`; they are
        // no longer than memory, and nothing else is lent of them.
        Ok(unsafe { slice::from_raw_parts(at, len) })
    }

    /// Elements to read and write; NULL is allowed where there are none.
    pub(crate) fn write<T: Plain>(&mut self, at: *mut T, len: usize) -> Result<&'a mut [T], WaveliftError> {
        if len == 0 {
            return Ok(&mut []);
        }
        self.take(at, len)?;
        // SAFETY: as in `read`; and writable.
        Ok(unsafe { slice::from_raw_parts_mut(at, len) })
    }

    /// One element to read and write.
    #[cfg(feature = "encode")]
    pub(crate) fn write_one<T: Plain>(&mut self, at: *mut T) -> Result<&'a mut T, WaveliftError> {
        self.take(at, 1)?;
        // SAFETY: as in `write`.
        Ok(unsafe { &mut *at })
    }

    /// A place for one value to be written later.
    pub(crate) fn place<T: Copy>(&mut self, at: *mut T) -> Result<Place<'a, T>, WaveliftError> {
        self.take(at, 1)?;
        Ok(Place { at, lender: PhantomData })
    }

    /// A state for the kernel to start afresh: what the memory held before has no meaning.
    pub(crate) fn state<S: State>(&mut self, at: *mut S) -> Result<&'a mut S::Of, WaveliftError> {
        self.take(at, 1)?;
        let state = at.cast::<S::Of>();
        // SAFETY: writable, as in `write`; `S` is as large and as aligned as `S::Of`, asserted where it is declared.
        unsafe { state.write(S::ZERO) };
        // SAFETY: as above; and it holds a value now.
        Ok(unsafe { &mut *state })
    }

    /// Samples and scratch.
    pub(crate) fn lent(
        &mut self,
        at: *const WaveliftLent,
    ) -> Result<(&'a mut [i32], &'a mut [i32]), WaveliftError> {
        let lent = self.copy(at)?;
        Ok((self.write(lent.samples, lent.samples_len)?, self.write(lent.scratch, lent.scratch_len)?))
    }

    /// Begins what lasts for many calls, in the memory at `at`; `'static`, since what `value` borrows from this loan
    /// is lent until the last of them.
    #[cfg(feature = "rows")]
    pub(crate) fn begin<S: Session>(
        mut self,
        at: *mut S,
        value: impl FnOnce(&mut Self) -> Result<S::Of, WaveliftError>,
    ) -> Result<(), WaveliftError>
    where
        Self: 'static,
    {
        self.take(at, 1)?;
        // SAFETY: writable, as in `write`, and large enough for a number. It ends what was begun there before.
        unsafe { at.cast::<u64>().write(0) };
        let value = value(&mut self)?;
        let begun = Begun { mark: S::MARK, ranges: self.ranges, value };
        // SAFETY: writable, as above; `S` is as large and as aligned as `Begun<S::Of>`, asserted where it is declared.
        unsafe { at.cast::<Begun<S::Of>>().write(begun) };
        Ok(())
    }

    /// What was begun at `at`. Whatever else this loan is given must not overlap what was lent then.
    #[cfg(feature = "rows")]
    pub(crate) fn resume<S: Session>(&mut self, at: *mut S) -> Result<&'a mut S::Of, WaveliftError> {
        address(at)?;
        // SAFETY: readable, as in `read`, and every pattern of bits is a number.
        if unsafe { at.cast::<u64>().read() } != S::MARK {
            return Err(WaveliftError::NotBegun);
        }
        // SAFETY: writable, as in `write`. The mark is there, so `begin` left a value, and nobody else writes there.
        let begun = unsafe { &mut *at.cast::<Begun<S::Of>>() };
        self.ranges = begun.ranges.clone();
        Ok(&mut begun.value)
    }

    /// Notes that `len` elements at `at` are lent, if they can be.
    fn take<T>(&mut self, at: *const T, len: usize) -> Result<(), WaveliftError> {
        let Ranges { lent, count } = &mut self.ranges;
        let start = address(at)?;
        let bytes = len.checked_mul(size_of::<T>()).filter(|bytes| isize::try_from(*bytes).is_ok());
        let end = bytes.and_then(|bytes| start.checked_add(bytes)).ok_or(WaveliftError::TooLong)?;
        if lent.iter().any(|lent| start < lent.end && lent.start < end) {
            return Err(WaveliftError::Overlap);
        }
        *lent.get_mut(*count).ok_or(WaveliftError::Refused)? = start..end;
        *count = count.saturating_add(1);
        Ok(())
    }
}

/// The address of a pointer that is neither NULL nor misaligned.
fn address<T>(at: *const T) -> Result<usize, WaveliftError> {
    if at.is_null() {
        Err(WaveliftError::NullPointer)
    } else if !at.is_aligned() {
        Err(WaveliftError::Misaligned)
    } else {
        Ok(at.addr())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::ptr::{null, null_mut};

    #[test]
    fn null_misaligned_and_endless_buffers_are_refused() {
        let words = [0_i32; 4];
        // SAFETY: what is lent is there, and nobody else's.
        let mut loan = unsafe { Loan::new() };
        assert_eq!(loan.take(null::<i32>(), 1), Err(WaveliftError::NullPointer));
        assert_eq!(loan.take(words.as_ptr().wrapping_byte_add(1), 1), Err(WaveliftError::Misaligned));
        assert_eq!(loan.take(words.as_ptr(), usize::MAX / 4), Err(WaveliftError::TooLong));
        assert_eq!(loan.take(words.as_ptr(), usize::MAX), Err(WaveliftError::TooLong));
        assert_eq!(loan.take(words.as_ptr(), 4), Ok(()));
    }

    #[test]
    fn buffers_may_touch_but_not_overlap() {
        let bytes = [0_u8; 8];
        let place = |from: usize| bytes.as_ptr().wrapping_add(from);
        // SAFETY: what is lent is there, and nobody else's.
        let mut loan = unsafe { Loan::new() };
        assert_eq!(loan.take(place(2), 3), Ok(()));
        for (from, len) in [(1, 2), (2, 1), (4, 1), (0, 8), (2, 3)] {
            assert_eq!(loan.take(place(from), len), Err(WaveliftError::Overlap), "{from} {len}");
        }
        assert_eq!(loan.take(place(0), 2), Ok(()));
        assert_eq!(loan.take(place(5), 3), Ok(()));
    }

    #[test]
    fn nothing_may_be_lent_as_null() {
        // SAFETY: what is lent is there, and nobody else's.
        let mut loan = unsafe { Loan::new() };
        assert!(loan.read::<u8>(null(), 0).unwrap().is_empty());
        assert!(loan.write::<u8>(null_mut(), 0).unwrap().is_empty());
    }
}
