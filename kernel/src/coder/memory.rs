//! The memory of a codec, for one use after another.

use super::residual::Models;
use super::tabled::{Lessons, Tables};

/// What a call needs of this it makes anew, so that what was there before never shows.
#[cfg(feature = "tabled")]
#[derive(Debug, PartialEq, Eq)]
#[expect(clippy::large_enum_variant, reason = "it is memory; all variants need about as much")]
pub(crate) enum Memory {
    Models(Models),
    Lessons(Lessons),
    Tables(Tables),
}

/// Models only: tables are not built.
#[cfg(not(feature = "tabled"))]
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Memory(Models);

#[cfg(feature = "tabled")]
impl Memory {
    /// Memory that can be the value of a `static`.
    pub(crate) const NEW: Self = Self::Models(Models::NEW);

    /// Models as they are at first; never `None`.
    pub(crate) fn models(&mut self) -> Option<&mut Models> {
        if !matches!(self, Self::Models(_)) {
            *self = Self::Models(Models::BLANK);
        }
        let Self::Models(models) = self else { return None };
        models.reset();
        Some(models)
    }

    /// Lessons of nothing yet; never `None`.
    pub(super) fn lessons(&mut self) -> Option<&mut Lessons> {
        *self = Self::Lessons(Lessons::NEW);
        if let Self::Lessons(lessons) = self { Some(lessons) } else { None }
    }

    /// Empty tables; never `None`.
    pub(super) fn tables(&mut self) -> Option<&mut Tables> {
        *self = Self::Tables(Tables::NEW);
        if let Self::Tables(tables) = self { Some(tables) } else { None }
    }
}

#[cfg(not(feature = "tabled"))]
impl Memory {
    /// Memory that can be the value of a `static`.
    pub(crate) const NEW: Self = Self(Models::NEW);

    /// Models as they are at first.
    pub(crate) fn models(&mut self) -> Option<&mut Models> {
        self.0.reset();
        Some(&mut self.0)
    }

    /// None in this build.
    pub(super) fn lessons(&mut self) -> Option<&mut Lessons> {
        None
    }

    /// None in this build.
    pub(super) fn tables(&mut self) -> Option<&mut Tables> {
        None
    }
}
