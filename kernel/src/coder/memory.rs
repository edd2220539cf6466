//! The memory of a codec, for one use after another.

use super::light::Chances;
use super::residual::Models;
use super::tabled::{Lessons, Tables};

/// What a call needs of this it makes anew, so that what was there before never shows. What is not built takes no room.
#[derive(Debug, PartialEq, Eq)]
#[cfg_attr(
    any(feature = "adaptive", feature = "light"),
    expect(clippy::large_enum_variant, reason = "it is memory; most uses need nearly all of it")
)]
pub(crate) enum Memory {
    Nothing,
    #[cfg(feature = "light")]
    Chances(Chances),
    #[cfg(feature = "adaptive")]
    Models(Models),
    #[cfg(feature = "tabled")]
    Lessons(Lessons),
    #[cfg(feature = "tabled")]
    Tables(Tables),
}

impl Memory {
    /// Memory that can be the value of a `static`.
    pub(crate) const NEW: Self = Self::Nothing;

    /// Chances as they are at first; `None` if they are not built.
    pub(crate) fn chances(&mut self) -> Option<&mut Chances> {
        #[cfg(feature = "light")]
        {
            *self = Self::Chances(Chances::NEW);
            if let Self::Chances(chances) = self { Some(chances) } else { None }
        }
        #[cfg(not(feature = "light"))]
        None
    }

    /// Models as they are at first; `None` if they are not built.
    pub(crate) fn models(&mut self) -> Option<&mut Models> {
        #[cfg(feature = "adaptive")]
        {
            if !matches!(self, Self::Models(_)) {
                *self = Self::Models(Models::BLANK);
            }
            let Self::Models(models) = self else { return None };
            models.reset();
            Some(models)
        }
        #[cfg(not(feature = "adaptive"))]
        None
    }

    /// Lessons of nothing yet; `None` if they are not built.
    pub(super) fn lessons(&mut self) -> Option<&mut Lessons> {
        #[cfg(feature = "tabled")]
        {
            *self = Self::Lessons(Lessons::NEW);
            if let Self::Lessons(lessons) = self { Some(lessons) } else { None }
        }
        #[cfg(not(feature = "tabled"))]
        None
    }

    /// Empty tables; `None` if they are not built.
    pub(super) fn tables(&mut self) -> Option<&mut Tables> {
        #[cfg(feature = "tabled")]
        {
            *self = Self::Tables(Tables::NEW);
            if let Self::Tables(tables) = self { Some(tables) } else { None }
        }
        #[cfg(not(feature = "tabled"))]
        None
    }
}
