//! Pictures of volumes: slices, and the brightest along a line of sight.
//!
//! A picture of a compressed file decodes only the bricks that it shows, at a coarse level if that is enough.

mod axis;
mod picture;
mod view;
mod window;

pub use axis::{Axis, UnknownAxis};
pub use picture::{Depth, Picture, PreviewError};
pub use view::{Select, Shown, View, of_container, of_source, suitable_level};
pub use window::{Window, WindowError};

#[cfg(test)]
mod tests;
