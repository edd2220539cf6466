//! From surfaces to files.

use wavelift_kernel::bits::BitEncoder;

use super::base_segment::{code_connectivity, code_depths, code_features, code_points, shifts};
use super::connectivity::{Connectivity, Given, Order};
use super::error::EncodeError;
use super::header::{Header, MOST_LEVELS, Segment};
use super::order::reordered;
use super::planes::{Cut, Depths, Part, Scan, Triple};
use super::rebuild::Shape;
use super::regions::Regions;
use super::{Deviation, Precision, Settings};
use crate::mesh::Point;
use crate::subdivision::{Hierarchy, SubdivisionSurface};
use crate::surface_wavelet::{forward, lossless};

/// A surface as a file.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// The file, any beginning of which decodes that holds the base mesh: `base_bytes` at least.
    pub bytes: Vec<u8>,
    /// Bytes up to the end of the base mesh.
    pub base_bytes: usize,
    /// The step of quantization, or the unit of integer coordinates.
    pub step: f64,
    /// How far the points of the whole file are from those given.
    pub deviation: Deviation,
}

/// A surface in the order of its file, and what connectivity the file tells.
struct Arranged {
    surface: SubdivisionSurface,
    mesh: Connectivity,
}

/// The surface with its base mesh in the order in which a file holds it, which is also that of what is decoded.
///
/// # Errors
/// What makes [`encode`] refuse a surface.
pub fn arranged(surface: &SubdivisionSurface) -> Result<SubdivisionSurface, EncodeError> {
    arrange(surface).map(|arranged| arranged.surface)
}

fn arrange(surface: &SubdivisionSurface) -> Result<Arranged, EncodeError> {
    if surface.base.is_empty() {
        return Err(EncodeError::Empty);
    }
    if surface.levels > MOST_LEVELS {
        return Err(EncodeError::Levels { levels: surface.levels });
    }
    if let Some(vertex) = surface.positions.iter().position(|point| !point.is_finite()) {
        return Err(EncodeError::NotFinite { vertex });
    }
    let base_vertices = surface.base.corners().iter().max().map_or(0, |&last| last as usize + 1);
    let expected =
        Hierarchy::new(base_vertices, &surface.base, &surface.features, surface.levels).finest_vertices();
    if expected != surface.positions.len() {
        return Err(EncodeError::Points { expected, actual: surface.positions.len() });
    }
    let numbers = [base_vertices, surface.base.len(), surface.base.corners().len()];
    let mut header = blank_header(surface, numbers);
    header.levels = 0;
    let given = Given::new(base_vertices, &surface.base)?;
    let mut scratch = Vec::new();
    // What is written here is written again later, in the segment of the base mesh.
    let (mesh, order) = walk(&header, given, &mut scratch);
    let surface = reordered(surface, mesh.faces.clone(), &order);
    Ok(Arranged { surface, mesh })
}

/// Walks over a mesh that was checked, and writes its connectivity.
fn walk(header: &Header, given: Given<'_>, bytes: &mut Vec<u8>) -> (Connectivity, Order) {
    bytes.resize(64, 0);
    let mut coder = BitEncoder::new(bytes);
    code_connectivity(&mut coder, header, Some(given)).expect("each side once: faces fit one after another")
}

fn blank_header(surface: &SubdivisionSurface, numbers: [usize; 3]) -> Header {
    Header {
        basis: crate::surface_wavelet::Basis::Bicubic,
        lossless: false,
        has_features: !surface.features.edges.is_empty() || !surface.features.vertices.is_empty(),
        levels: surface.levels,
        tangential: 0,
        step: 1.0,
        numbers: numbers.map(|number| number as u32),
        faces_per_region: None,
        base: Segment::default(),
        parts: Vec::new(),
    }
}

/// Encodes a surface. What is decoded has its vertices and faces in another order, that of [`arranged`].
///
/// # Errors
/// [`EncodeError`]: what is wrong with the surface or the settings.
///
/// Cost: about 3 µs a vertex of the finest mesh for each try; a precision other than [`Precision::Step`] and
/// [`Precision::Lossless`] takes up to ten tries.
pub fn encode(surface: &SubdivisionSurface, settings: &Settings) -> Result<Encoded, EncodeError> {
    let asked = match settings.precision {
        Precision::Step(asked) | Precision::Rms(asked) | Precision::Lossless { unit: asked } => asked,
        Precision::Bytes(_) => 1.0,
    };
    if !(asked.is_finite() && asked > 0.0) {
        return Err(EncodeError::Precision { asked });
    }
    let arranged = arrange(surface)?;
    let hierarchy = Hierarchy::from(&arranged.surface);
    let encoder = Encoder::new(&arranged, &hierarchy, settings);
    match settings.precision {
        Precision::Step(step) => encoder.lossy(step),
        Precision::Rms(rms) => encoder.within(rms),
        Precision::Bytes(bytes) => encoder.in_bytes(bytes),
        Precision::Lossless { unit } => encoder.lossless(unit),
    }
}

/// What a file is to hold.
struct Quantized {
    header: Header,
    numbers: Vec<Triple>,
    deviation: Deviation,
}

struct Encoder<'a> {
    arranged: &'a Arranged,
    hierarchy: &'a Hierarchy,
    header: Header,
    /// Coefficients, unless coding is lossless.
    coefficients: Vec<Point>,
    regions: Option<Regions>,
}

impl<'a> Encoder<'a> {
    fn new(arranged: &'a Arranged, hierarchy: &'a Hierarchy, settings: &Settings) -> Self {
        let surface = &arranged.surface;
        let numbers = [hierarchy.vertices(0), surface.base.len(), surface.base.corners().len()];
        let mut header = blank_header(surface, numbers);
        header.basis = settings.basis;
        header.tangential = settings.tangential.min(16);
        header.faces_per_region = settings.faces_per_region.map(|faces| faces.get());
        let mut coefficients = Vec::new();
        if !matches!(settings.precision, Precision::Lossless { .. }) {
            coefficients.clone_from(&surface.positions);
            forward(header.basis, hierarchy, &mut coefficients);
        }
        let regions =
            header.faces_per_region.map(|faces| Regions::new(hierarchy, &surface.base, faces as usize));
        Self { arranged, hierarchy, header, coefficients, regions }
    }

    fn deviation(&self, points: &[Point]) -> Deviation {
        Deviation::between(&self.arranged.surface, points)
    }

    fn lossy(&self, step: f64) -> Result<Encoded, EncodeError> {
        let quantized = self.quantized(step)?;
        Ok(self.file(quantized))
    }

    fn quantized(&self, step: f64) -> Result<Quantized, EncodeError> {
        let header = Header { step, ..self.header.clone() };
        let shape = Shape { header: &header, hierarchy: self.hierarchy, level: self.hierarchy.steps().len() };
        let (numbers, points) = shape.quantize(&self.coefficients)?;
        if !points.iter().all(|point| point.is_finite()) {
            return Err(EncodeError::Precision { asked: step });
        }
        Ok(Quantized { deviation: self.deviation(&points), header, numbers })
    }

    fn lossless(&self, unit: f64) -> Result<Encoded, EncodeError> {
        let header = Header { step: unit, lossless: true, tangential: 0, ..self.header.clone() };
        let mut numbers = Vec::with_capacity(self.arranged.surface.positions.len());
        for point in &self.arranged.surface.positions {
            let scaled = point.to_array().map(|value| (value / unit).round());
            // Coefficients are up to some times as large, and have to fit 31 bits too.
            if scaled.iter().any(|value| value.abs() >= f64::from(1 << 26)) {
                return Err(EncodeError::Range { step: unit });
            }
            numbers.push(scaled.map(|value| value as i32));
        }
        let points: Vec<_> = numbers
            .iter()
            .map(|point| Point::from_array(point.map(|value| f64::from(value) * unit)))
            .collect();
        if !points.iter().all(|point| point.is_finite()) {
            return Err(EncodeError::Precision { asked: unit });
        }
        lossless::forward(header.basis, self.hierarchy, &mut numbers);
        Ok(self.file(Quantized { header, numbers, deviation: self.deviation(&points) }))
    }

    /// The coarsest step found whose deviation along normals is at most `rms`.
    fn within(&self, rms: f64) -> Result<Encoded, EncodeError> {
        let mut step = rms * 4.0;
        let mut best: Option<Quantized> = None;
        for _ in 0..60 {
            let quantized = self.quantized(step)?;
            let found = quantized.deviation.rms_along_normals;
            if found <= rms && best.as_ref().is_none_or(|best| best.header.step < step) {
                best = Some(quantized);
            }
            // Near enough, or not much is to be gained by going on.
            let is_near = found <= rms && found > 0.95 * rms;
            if is_near || best.as_ref().is_some_and(|best| best.header.step > step || found < 1e-3 * rms) {
                break;
            }
            step *= (0.98 * rms / found.max(1e-300)).clamp(0.2, 4.0);
        }
        best.map(|best| self.file(best)).ok_or(EncodeError::Range { step })
    }

    /// A file of a step fine enough to have `bytes`, cut there.
    fn in_bytes(&self, bytes: usize) -> Result<Encoded, EncodeError> {
        let [low, high] = self
            .arranged
            .surface
            .positions
            .iter()
            .fold([Point::INFINITY, Point::NEG_INFINITY], |[low, high], &point| {
                [low.min(point), high.max(point)]
            });
        let mut step = ((high - low).length() * 4e-3).max(1e-30);
        let mut file = self.lossy(step)?;
        while file.bytes.len() < bytes && file.deviation.rms > 1e-9 * (high - low).length() {
            step /= 2.0;
            match self.lossy(step) {
                Ok(finer) => file = finer,
                // Files hold nothing finer.
                Err(EncodeError::Range { .. }) => break,
                Err(error) => return Err(error),
            }
        }
        file.bytes.truncate(bytes.max(file.base_bytes));
        Ok(file)
    }

    fn file(&self, quantized: Quantized) -> Encoded {
        let Quantized { mut header, numbers, deviation } = quantized;
        let depths = self.depths(&header, &numbers);
        let base = self.base_segment(&header, &depths, &numbers);
        let mut known = vec![[0; 3]; numbers.len()];
        let high = numbers[..self.hierarchy.vertices(0)].iter();
        for (known, number) in known.iter_mut().zip(high) {
            *known = number.map(|value| value >> depths.base_bits << depths.base_bits);
        }
        let parts: Vec<Vec<u8>> = super::parts(self.hierarchy, self.regions.as_ref())
            .map(|part| self.planes(&depths, part, &mut known, &numbers))
            .collect();
        header.base = Segment::of(&base);
        header.parts = parts.iter().map(|part| Segment::of(part)).collect();
        let mut bytes = header.to_bytes();
        bytes.extend(base);
        let base_bytes = bytes.len();
        parts.iter().for_each(|part| bytes.extend(part));
        Encoded { bytes, base_bytes, step: header.step, deviation }
    }

    fn depths(&self, header: &Header, numbers: &[Triple]) -> Depths {
        let length = |value: u32| (u32::BITS - value.leading_zeros()) as i32;
        let mut bits = Vec::new();
        for (step, each) in self.hierarchy.steps().iter().enumerate() {
            let added = &numbers[self.hierarchy.vertices(step)..each.split.finer_vertices()];
            let all = added.iter().fold([0; 3], |all: [u32; 3], number| {
                std::array::from_fn(|axis| all[axis] | number[axis].unsigned_abs())
            });
            bits.push(all.map(length));
        }
        let mut depths = Depths { bits, ..shifts(header) };
        // Points of the base mesh are as precise as the first planes of the details.
        depths.base_bits = depths.planes().saturating_sub(depths.base_shift).min(30);
        depths
    }

    fn base_segment(&self, header: &Header, depths: &Depths, numbers: &[Triple]) -> Vec<u8> {
        let Arranged { surface, mesh } = self.arranged;
        grown(|coder| {
            let given = Given::new(mesh.origins.len(), &mesh.faces).expect("checked when it was arranged");
            code_connectivity(coder, header, Some(given)).expect("walked over before");
            if header.has_features {
                code_features(coder, mesh, &surface.features);
            }
            code_depths(coder, header, Some(depths));
            code_points(coder, mesh, depths.base_bits, &mut numbers[..mesh.origins.len()].to_vec());
        })
    }

    fn planes(&self, depths: &Depths, part: Part<'_>, known: &mut [Triple], numbers: &[Triple]) -> Vec<u8> {
        let before = known.to_vec();
        let mut bytes = vec![0; numbers.len() / 4 + 1024];
        loop {
            let coder = BitEncoder::new(&mut bytes);
            let scan = Scan::new(coder, self.hierarchy, depths, part.clone(), (known, Some(numbers)));
            let (coder, cut) = scan.run();
            debug_assert_eq!(cut, Cut::NONE);
            if let Some(len) = coder.finish() {
                bytes.truncate(len);
                return bytes;
            }
            let room = bytes.len() * 4;
            bytes.resize(room, 0);
            known.copy_from_slice(&before);
        }
    }
}

/// What is coded, in as many bytes as it takes.
fn grown(code: impl Fn(&mut BitEncoder<'_>)) -> Vec<u8> {
    let mut bytes = vec![0; 1024];
    loop {
        let mut coder = BitEncoder::new(&mut bytes);
        code(&mut coder);
        if let Some(len) = coder.finish() {
            bytes.truncate(len);
            return bytes;
        }
        let room = bytes.len() * 4;
        bytes.resize(room, 0);
    }
}
