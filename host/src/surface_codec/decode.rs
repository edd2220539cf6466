//! From files, and beginnings of files, to surfaces.

use wavelift_kernel::bits::BitDecoder;

use super::base_segment::{code_connectivity, code_depths, code_features, code_points};
use super::error::DecodeError;
use super::header::Header;
use super::planes::{Cut, Depths, Part, Scan, Triple};
use super::rebuild::Shape;
use super::regions::Regions;
use crate::mesh::Features;
use crate::subdivision::{Hierarchy, SubdivisionSurface};

/// What a decoder accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Vertices of the finest mesh, each of which takes about 100 bytes of memory.
    pub vertices: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { vertices: 1 << 26 }
    }
}

/// Decodes a file or any beginning of one that holds the base mesh. The surface has all its levels in any case; what bytes
/// are missing makes it less precise.
///
/// # Errors
/// [`DecodeError`]: what is wrong with the bytes. Damage behind the base mesh is noticed in files that are whole.
///
/// Cost: about 3 µs a vertex of the finest mesh; memory as [`Limits`] says.
pub fn decode(bytes: &[u8], limits: Limits) -> Result<SubdivisionSurface, DecodeError> {
    let mut file = File::open(bytes, limits)?;
    let (all, level) = (file.all(), file.header.levels);
    file.surface(&all, level)
}

/// Decodes a level, 0 being the base mesh, and of coefficients no more than it takes: the surface that is returned has so
/// many levels, and the control points that the wavelets leave at this one, which say on the whole where the surface is, and
/// not where the vertices are that finer levels keep. A file by regions is read up to the end of what these share for levels
/// up to 2; any lossless file up to the last bit of the level. Other files are read up to the last plane.
///
/// # Errors
/// As [`decode`], and [`DecodeError::Level`].
///
/// Cost: up to half that of [`decode`] where that ends early; memory for the connectivity of all levels.
pub fn decode_level(bytes: &[u8], level: u32, limits: Limits) -> Result<SubdivisionSurface, DecodeError> {
    let mut file = File::open(bytes, limits)?;
    file.check_level(level)?;
    let all = file.all();
    file.surface(&all, level)
}

/// The finest level of a file.
///
/// # Errors
/// What is wrong with the header.
pub fn levels(bytes: &[u8]) -> Result<u32, DecodeError> {
    Ok(Header::parse(bytes)?.0.levels)
}

/// Number of regions of a file; none if it was not coded by regions.
///
/// # Errors
/// What is wrong with the header.
pub fn regions(bytes: &[u8]) -> Result<usize, DecodeError> {
    Ok(Header::parse(bytes)?.0.regions())
}

/// Decodes what a level of a region needs, as [`decode_level`] does: its faces of the base mesh, in the range that is returned
/// too, are as the whole file makes them; the rest of the surface is coarse.
///
/// # Errors
/// As [`decode_level`], and [`DecodeError::Region`].
///
/// Cost: coding only of the region and its neighbours, but memory and transforms of all.
pub fn decode_region(
    bytes: &[u8],
    region: usize,
    level: u32,
    limits: Limits,
) -> Result<(SubdivisionSurface, std::ops::Range<usize>), DecodeError> {
    let mut file = File::open(bytes, limits)?;
    file.check_level(level)?;
    let regions = match &file.regions {
        Some(regions) if region < regions.len() => regions,
        other => {
            return Err(DecodeError::Region {
                asked: region,
                regions: other.as_ref().map_or(0, Regions::len),
            });
        }
    };
    let mut needed = vec![0];
    needed.extend(regions.with_neighbours(&file.surface.base, region).iter().map(|region| region + 1));
    let faces = regions.faces(region);
    Ok((file.surface(&needed, level)?, faces))
}

/// A file whose base mesh is read.
struct File<'a> {
    header: Header,
    /// Bytes behind the base mesh.
    rest: &'a [u8],
    hierarchy: Hierarchy,
    depths: Depths,
    regions: Option<Regions>,
    numbers: Vec<Triple>,
    /// Without points.
    surface: SubdivisionSurface,
}

impl<'a> File<'a> {
    fn open(bytes: &'a [u8], limits: Limits) -> Result<Self, DecodeError> {
        let (header, header_len) = Header::parse(bytes)?;
        check_size(&header, limits)?;
        let end = header_len + header.base.len as usize;
        let base = bytes.get(header_len..end).ok_or(DecodeError::Truncated { needed: end })?;
        if !header.base.holds(base) {
            return Err(DecodeError::Checksum { part: "base mesh" });
        }
        let mut coder = BitDecoder::new(base);
        let malformed = DecodeError::Malformed { what: "its base mesh contradicts itself" };
        let (mesh, _) = code_connectivity(&mut coder, &header, None).ok_or(malformed)?;
        let features = if header.has_features {
            code_features(&mut coder, &mesh, &Features::default())
        } else {
            Features::default()
        };
        let depths = code_depths(&mut coder, &header, None);
        if depths.bits.iter().flatten().chain([&(depths.base_bits as i32)]).any(|&bits| bits > 30) {
            return Err(DecodeError::Malformed { what: "its coefficients have too many bits" });
        }
        let mut numbers = vec![[0; 3]; mesh.origins.len()];
        code_points(&mut coder, &mesh, depths.base_bits, &mut numbers);
        let hierarchy = Hierarchy::new(numbers.len(), &mesh.faces, &features, header.levels);
        check_vertices(hierarchy.finest_vertices() as u64, limits)?;
        numbers.resize(hierarchy.finest_vertices(), [0; 3]);
        let faces_per_region = header.faces_per_region.map(|faces| faces as usize);
        let regions = faces_per_region.map(|faces| Regions::new(&hierarchy, &mesh.faces, faces));
        let surface =
            SubdivisionSurface { base: mesh.faces, features, levels: header.levels, positions: Vec::new() };
        Ok(Self { header, rest: &bytes[end..], hierarchy, depths, regions, numbers, surface })
    }

    /// Refuses a level that there is not.
    fn check_level(&self, level: u32) -> Result<(), DecodeError> {
        let levels = self.header.levels;
        if level <= levels { Ok(()) } else { Err(DecodeError::Level { asked: level, levels }) }
    }

    /// All parts.
    fn all(&self) -> Vec<usize> {
        (0..self.header.parts.len()).collect()
    }

    /// A level of the surface from some of the parts.
    fn surface(&mut self, needed: &[usize], level: u32) -> Result<SubdivisionSurface, DecodeError> {
        let steps = level as usize;
        let mut cuts = Vec::new();
        let mut start = 0;
        for (index, part) in super::parts(&self.hierarchy, self.regions.as_ref()).enumerate() {
            let segment = self.header.parts[index];
            let bytes = &self.rest[start.min(self.rest.len())..];
            let bytes = &bytes[..bytes.len().min(segment.len as usize)];
            start = start.saturating_add(segment.len as usize);
            // What only finer steps have a part in.
            let is_finer = !part.base && part.steps.start >= steps;
            if is_finer || !needed.contains(&index) {
                cuts.push(Cut::NONE);
                continue;
            }
            let is_whole = bytes.len() == segment.len as usize;
            if is_whole && !segment.holds(bytes) {
                return Err(DecodeError::Checksum { part: "part of coefficients" });
            }
            let coder = if is_whole { BitDecoder::new(bytes) } else { BitDecoder::of_prefix(bytes) };
            let part = Part { until: steps, ..part };
            let scan = Scan::new(coder, &self.hierarchy, &self.depths, part, (&mut self.numbers, None));
            cuts.push(scan.run().1);
        }
        let unknown = |vertex: usize, component: usize| self.unknown(&cuts, vertex, component);
        let shape = Shape { header: &self.header, hierarchy: &self.hierarchy, level: steps };
        let positions = shape.points(&self.numbers, &unknown);
        if !positions.iter().all(|point| point.is_finite()) {
            return Err(DecodeError::Malformed { what: "its coordinates are too large" });
        }
        Ok(SubdivisionSurface { positions, levels: level, ..self.surface.clone() })
    }

    fn unknown(&self, cuts: &[Cut], vertex: usize, component: usize) -> u32 {
        let region = self.regions.as_ref().and_then(|regions| regions.of_vertex(vertex));
        let cut = &cuts[region.map_or(0, |region| region as usize + 1)];
        let steps = self.hierarchy.steps();
        if vertex < self.hierarchy.vertices(0) {
            return cut.unknown(vertex, component, self.depths.base_shift).min(self.depths.base_bits);
        }
        let step = steps.partition_point(|step| step.split.finer_vertices() <= vertex);
        cut.unknown(vertex, component, self.depths.shifts[step]).min(self.depths.bits[step][component] as u32)
    }
}

/// Refuses what must be too large, before anything is read.
fn check_size(header: &Header, limits: Limits) -> Result<(), DecodeError> {
    let [vertices, faces, corners] = header.numbers.map(u64::from);
    let (mut edges, mut faces, mut sides, mut all) = (corners / 2, faces, corners, vertices);
    for _ in 0..header.levels {
        all = all.saturating_add(edges).saturating_add(faces);
        (edges, faces, sides) =
            (edges.saturating_mul(2).saturating_add(sides), sides, sides.saturating_mul(4));
    }
    check_vertices(all.max(corners / 8), limits)
}

fn check_vertices(vertices: u64, limits: Limits) -> Result<(), DecodeError> {
    let limit = limits.vertices.min(u64::from(u32::MAX) / 4);
    if vertices > limit { Err(DecodeError::TooLarge { vertices, limit }) } else { Ok(()) }
}
