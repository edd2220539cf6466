//! What a picture shows of a volume, and how its values are gathered.

use std::num::NonZeroUsize;

use super::{Axis, Picture};
use crate::codec::{Container, ContainerError, Part, Region};
use crate::progress::{Progress, Stopped, tell};
use crate::volume::sample::each_f64;
use crate::volume::{Header, ReadError, Source};

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// The samples at one place along an axis, counted at full resolution; `None` for the middle one.
    Slice(Axis, Option<u64>),
    /// The largest of all samples along an axis.
    Maximum(Axis),
}

impl View {
    /// The axis that it is seen along.
    pub const fn axis(self) -> Axis {
        match self {
            Self::Slice(axis, _) | Self::Maximum(axis) => axis,
        }
    }
}

/// Which of several time steps and components a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Select {
    /// The time step.
    pub step: u64,
    /// The component; `None` for red, green and blue where samples have three or four, else the first.
    pub component: Option<u32>,
}

/// A picture cannot show what it is asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Shown {
    /// A place beyond the end of the axis.
    #[error("there is no slice {} = {at}: the last one is {last}", axis.name())]
    NoSuchSlice {
        /// The axis.
        axis: Axis,
        /// The place asked for.
        at: u64,
        /// The last place.
        last: u64,
    },
    /// A time step that is not there.
    #[error("there is no time step {asked}: the file has {steps}, the first is 0")]
    NoSuchStep {
        /// The step asked for.
        asked: u64,
        /// Number of time steps.
        steps: u64,
    },
    /// A component that is not there.
    #[error("there is no component {asked}: samples have {components}, the first is 0")]
    NoSuchComponent {
        /// The component asked for.
        asked: u32,
        /// Values of a sample.
        components: u32,
    },
    /// More pixels than a picture can have.
    #[error(
        "a picture of {width}x{height} pixels is too large: 65536 along each side are the most; choose a coarser level"
    )]
    TooLarge {
        /// Pixels to the right.
        width: u64,
        /// Pixels down.
        height: u64,
    },
    /// A compressed file could not be read.
    #[error(transparent)]
    Container(#[from] ContainerError),
    /// A file could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Most pixels along a side of a picture.
const MOST_PIXELS: u64 = 1 << 16;

/// Samples that are decoded at a time, about.
const PIECE_SAMPLES: u64 = 1 << 24;

/// The coarsest level at which the longer side of a picture still has `size` pixels, or full resolution.
///
/// # Errors
/// [`ContainerError`]: a step that is not there, or damaged.
pub fn suitable_level(container: &Container, view: View, step: u64, size: u64) -> Result<u8, ContainerError> {
    let coarsest = container.step(step)?.readable_levels();
    let longer = view.axis().across().map(|axis| container.head().extent[axis]).into_iter().max();
    let is_enough = |level: &u8| longer.unwrap_or(1).div_ceil(1 << level) >= size;
    Ok((0..=coarsest).rev().find(is_enough).unwrap_or(0))
}

/// A picture of a compressed file at a level. A slice that the level has not is that before it. `progress` counts the
/// values that are read.
///
/// # Errors
/// [`Shown`].
///
/// Cost: that of decoding the bricks it meets; memory for some planes of samples.
pub fn of_container(
    container: &Container,
    view: View,
    select: Select,
    level: u8,
    (threads, progress): (Option<NonZeroUsize>, Progress<'_>),
) -> Result<Picture, Shown> {
    let whole = container.header()?;
    check(&whole, select)?;
    let range = range_of(view, whole.extent)?;
    let (axis, step) = (view.axis().number(), 1_u64 << level);
    let mut from = [0; 3];
    let mut to = whole.extent;
    // The sample before, which the level has.
    (from[axis], to[axis]) = (range[0] / step * step, range[1]);
    let part = |from, to| Part {
        level,
        region: Some(Region { from, to }),
        step: Some(select.step),
        component: select.component.or((!is_color(&whole)).then_some(0)),
    };
    let header = container.header_of(&part(from, to))?;
    let mut canvas = Canvas::new(view.axis(), &header, None)?;
    let plane = header.extent[0].saturating_mul(header.extent[1]).max(1);
    let slab = (PIECE_SAMPLES / plane).max(1).saturating_mul(step).next_multiple_of(64.max(step));
    let mut z = from[2];
    while z < to[2] {
        let end = z.saturating_add(slab).min(to[2]);
        let ([x0, y0, _], [x1, y1, _]) = (from, to);
        let values = container.read_values(&part([x0, y0, z], [x1, y1, end]), threads, progress)?;
        canvas.add(&values, (z - from[2]).div_ceil(step));
        z = end;
    }
    Ok(canvas.finish())
}

/// A picture of any file, at full resolution. `progress` counts the values that are read.
///
/// # Errors
/// [`Shown`].
///
/// Cost: one pass over the time step, or over one plane for a slice along z; memory for one plane.
pub fn of_source(
    source: &mut dyn Source,
    view: View,
    select: Select,
    progress: Progress<'_>,
) -> Result<Picture, Shown> {
    let header = source.header().clone();
    check(&header, select)?;
    let range = range_of(view, header.extent)?;
    let planes = if view.axis() == Axis::Z { range } else { [0, header.extent[2]] };
    let mut canvas = Canvas::new(view.axis(), &header, Some((select.component, range)))?;
    let plane = header.plane_bytes().unwrap_or(u64::MAX);
    let mut values = Vec::new();
    let start = header.step_bytes().unwrap_or(u64::MAX).saturating_mul(select.step);
    source.seek(start.saturating_add(plane.saturating_mul(planes[0])))?;
    let too_large = || ReadError::TooLarge { path: "a plane of samples".into(), bytes: plane };
    let len = usize::try_from(plane).map_err(|_| too_large())?;
    values.try_reserve_exact(len).map_err(|_| too_large())?;
    values.resize(len, 0);
    for z in planes[0]..planes[1] {
        source.read(&mut values)?;
        canvas.add(&values, z);
        tell(progress, (len / header.element.bytes()) as u64)?;
    }
    Ok(canvas.finish())
}

fn check(header: &Header, select: Select) -> Result<(), Shown> {
    if select.step >= header.steps {
        return Err(Shown::NoSuchStep { asked: select.step, steps: header.steps });
    }
    match select.component {
        Some(asked) if asked >= header.components => {
            Err(Shown::NoSuchComponent { asked, components: header.components })
        }
        _ => Ok(()),
    }
}

/// The samples along the axis of sight that are shown.
fn range_of(view: View, extent: [u64; 3]) -> Result<[u64; 2], Shown> {
    let axis = view.axis();
    let length = extent[axis.number()];
    match view {
        View::Maximum(_) => Ok([0, length]),
        View::Slice(_, at) => {
            let at = at.unwrap_or(length / 2);
            if at < length {
                Ok([at, at + 1])
            } else {
                Err(Shown::NoSuchSlice { axis, at, last: length - 1 })
            }
        }
    }
}

const fn is_color(header: &Header) -> bool {
    matches!(header.components, 3 | 4)
}

/// The values of a picture while they are gathered: the largest so far for each pixel.
struct Canvas {
    axis: Axis,
    header: Header,
    /// The components that are shown.
    first: usize,
    channels: usize,
    /// The samples along the axis that are shown.
    range: [u64; 2],
    picture: Picture,
}

impl Canvas {
    /// For values of `header`: all that comes is shown, or of each sample one component, within a range of the axis.
    fn new(axis: Axis, header: &Header, chosen: Option<(Option<u32>, [u64; 2])>) -> Result<Self, Shown> {
        let [width, height] = axis.across().map(|across| header.extent[across]);
        if width.max(height) > MOST_PIXELS {
            return Err(Shown::TooLarge { width, height });
        }
        let (component, range) = chosen.unwrap_or((None, [0, header.extent[axis.number()]]));
        let channels = if component.is_none() && is_color(header) { 3 } else { 1 };
        let spacing = header.metadata.spacing();
        let picture = Picture {
            size: [width as u32, height as u32],
            channels,
            element: header.element,
            values: vec![f64::NAN; (width * height) as usize * channels],
            pixel: spacing.map(|spacing| axis.across().map(|across| spacing[across])),
        };
        let first = component.unwrap_or(0) as usize;
        Ok(Self { axis, header: header.clone(), first, channels, range, picture })
    }

    /// Adds the values of whole planes, from plane `z` on.
    fn add(&mut self, values: &[u8], z: u64) {
        let [width, height, _] = self.header.extent;
        let (components, size) = (u64::from(self.header.components), self.header.element.bytes());
        let row_bytes = (width * components) as usize * size;
        let [from, to] = self.range;
        let shown = |place: u64| (from..to).contains(&place);
        for (number, row) in (0..).zip(values.chunks_exact(row_bytes)) {
            let (y, z) = (number % height, z + number / height);
            // The pixel of the first sample of the row, and the samples of it that are shown.
            let (pixel, samples) = match self.axis {
                Axis::X => (z * height + y, self.range),
                Axis::Y if shown(y) => (z * width, [0, width]),
                Axis::Z if shown(z) => (y * width, [0, width]),
                Axis::Y | Axis::Z => continue,
            };
            let [from, to] = samples.map(|sample| (sample * components) as usize * size);
            self.add_row(&row[from..to], pixel as usize);
        }
    }

    /// Adds samples to the pixel with a number, or along x to it and those to its right.
    fn add_row(&mut self, row: &[u8], pixel: usize) {
        let (components, first, channels) = (self.header.components as usize, self.first, self.channels);
        let stride = if self.axis == Axis::X { 0 } else { channels };
        let pixels = &mut self.picture.values[pixel * channels..];
        let mut number = 0;
        each_f64(self.header.element, row, &mut |value| {
            let (sample, component) = (number / components, number % components);
            number += 1;
            if let Some(channel) = component.checked_sub(first).filter(|channel| *channel < channels) {
                let pixel = &mut pixels[sample * stride + channel];
                // The first value takes the place of NaN.
                *pixel = pixel.max(value);
            }
        });
    }

    fn finish(self) -> Picture {
        self.picture
    }
}
