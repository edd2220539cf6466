//! Whole files.

use super::*;
use crate::mesh::{Faces, Features, Point, PolygonMesh};
use crate::subdivision::{Split, SubdivisionSurface};

/// Cubes joined to a frame with a hole, in a row: genus 1 each.
fn rings(count: u32) -> PolygonMesh {
    let mut points = Vec::new();
    let mut faces = Faces::default();
    for ring in 0..count {
        let first = points.len() as u32;
        for i in 0..16_u32 {
            // Outer and inner square, below and above.
            let (corner, inner, up) = (i % 4, i / 4 % 2, i / 8);
            let radius = if inner == 1 { 0.5 } else { 1.0 };
            let [x, y] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][corner as usize];
            points.push(Point::new(x * radius + 3.0 * f64::from(ring), y * radius, f64::from(up) * 0.5));
        }
        let at = |corner: u32, inner: u32, up: u32| first + corner % 4 + 4 * inner + 8 * up;
        for corner in 0..4 {
            let next = corner + 1;
            faces.push(&[at(corner, 0, 0), at(next, 0, 0), at(next, 0, 1), at(corner, 0, 1)]);
            faces.push(&[at(next, 1, 0), at(corner, 1, 0), at(corner, 1, 1), at(next, 1, 1)]);
            faces.push(&[at(corner, 0, 1), at(next, 0, 1), at(next, 1, 1), at(corner, 1, 1)]);
            faces.push(&[at(next, 0, 0), at(corner, 0, 0), at(corner, 1, 0), at(next, 1, 0)]);
        }
    }
    PolygonMesh::new(points, faces)
}

/// A surface over a base mesh: smooth subdivision, then bumps.
fn surface(base: PolygonMesh, levels: u32) -> SubdivisionSurface {
    let mut surface = SubdivisionSurface::from(base);
    for _ in 0..levels {
        let split = Split::new(surface.positions.len(), surface.level(surface.levels).faces());
        let added = vec![Point::ZERO; split.finer_vertices() - split.coarser_vertices()];
        surface.refine(&split, &added);
    }
    let hierarchy = Hierarchy::from(&surface);
    crate::surface_wavelet::inverse(Basis::Bicubic, &hierarchy, &mut surface.positions);
    for point in &mut surface.positions {
        let wave = (7.0 * point.x).sin() * (5.0 * point.y).cos() + (9.0 * point.z).sin();
        *point += Point::new(0.3, 0.2, 1.0) * (0.02 * wave);
    }
    surface
}

/// Open, with a pentagon and a triangle, sharp edges and a sharp vertex.
fn open_and_sharp() -> PolygonMesh {
    let faces: Faces = [&[0, 1, 2, 3, 4][..], &[1, 0, 5, 6], &[2, 1, 6], &[3, 2, 6, 7]].into_iter().collect();
    let flat =
        [[0.0, 0.0], [2.0, 0.0], [3.0, 1.5], [1.0, 3.0], [-1.0, 1.0], [0.0, -2.0], [3.0, -1.0], [4.0, 3.0]];
    let mut mesh = PolygonMesh::new(flat.map(|[x, y]| Point::new(x, y, 0.1 * x * y)).to_vec(), faces);
    mesh.features = Features { edges: vec![[0, 1], [1, 6]], vertices: vec![2] };
    mesh
}

fn cases() -> Vec<SubdivisionSurface> {
    vec![surface(rings(1), 3), surface(rings(3), 2), surface(open_and_sharp(), 4), surface(rings(1), 0)]
}

#[test]
fn files_keep_what_they_promise() {
    for surface in cases() {
        for rms in [1e-2, 1e-4] {
            let file = encode(&surface, &Settings::new(Precision::Rms(rms))).unwrap();
            let decoded = decode(&file.bytes, Limits::default()).unwrap();
            let expected = arranged(&surface).unwrap();
            assert_eq!(
                (&decoded.base, &decoded.features, decoded.levels),
                (&expected.base, &expected.features, expected.levels)
            );
            let deviation = Deviation::between(&expected, &decoded.positions);
            assert_eq!(deviation, file.deviation);
            assert!(deviation.rms_along_normals <= rms, "{deviation:?}");
        }
    }
}

/// The order of the file keeps faces, sides and points together.
#[test]
fn arranging_keeps_the_surface() {
    for surface in cases() {
        let other = arranged(&surface).unwrap();
        let of = |surface: &SubdivisionSurface| {
            let mesh = surface.level(surface.levels);
            let mut faces: Vec<Vec<[u64; 3]>> = mesh
                .faces()
                .iter()
                .map(|face| {
                    let mut corners: Vec<_> = face
                        .iter()
                        .map(|&corner| mesh.positions[corner as usize].to_array().map(f64::to_bits))
                        .collect();
                    let first = (0..corners.len()).min_by_key(|&corner| corners[corner]).unwrap();
                    corners.rotate_left(first);
                    corners
                })
                .collect();
            faces.sort_unstable();
            let sharp = |vertex: &u32| mesh.positions[*vertex as usize].to_array().map(f64::to_bits);
            let mut sharp: Vec<_> =
                mesh.features.edges.iter().flatten().chain(&mesh.features.vertices).map(sharp).collect();
            sharp.sort_unstable();
            (faces, sharp)
        };
        assert_eq!(of(&surface), of(&other));
        assert_eq!(arranged(&other).unwrap(), other);
    }
}

#[test]
fn integers_come_back_exactly() {
    for surface in cases() {
        for basis in Basis::ALL {
            let unit = 2_f64.powi(-12);
            let settings = Settings { basis, ..Settings::new(Precision::Lossless { unit }) };
            let file = encode(&surface, &settings).unwrap();
            let decoded = decode(&file.bytes, Limits::default()).unwrap();
            let rounded = |point: &Point| point.to_array().map(|value| (value / unit).round() * unit);
            let expected: Vec<_> = arranged(&surface).unwrap().positions.iter().map(rounded).collect();
            assert_eq!(decoded.positions.iter().map(|point| point.to_array()).collect::<Vec<_>>(), expected);
        }
    }
}

#[test]
fn every_beginning_is_a_surface_and_longer_ones_are_better() {
    for precision in [Precision::Step(1e-4), Precision::Lossless { unit: 2_f64.powi(-14) }] {
        let surface = surface(rings(2), 3);
        let basis = if matches!(precision, Precision::Step(_)) { Basis::Bicubic } else { Basis::Bilinear };
        let file = encode(&surface, &Settings { basis, ..Settings::new(precision) }).unwrap();
        let expected = arranged(&surface).unwrap();
        let error = |len: usize| {
            let decoded = decode(&file.bytes[..len], Limits::default()).unwrap();
            Deviation::between(&expected, &decoded.positions).rms
        };
        let room = file.bytes.len() - file.base_bytes;
        let errors: Vec<_> = (0..=24).map(|part| error(file.base_bytes + room * part / 24)).collect();
        assert!(errors.is_sorted_by(|before, after| *after <= before * 1.02), "{errors:?}");
        assert!(errors[24] < errors[0] / 100.0, "{errors:?}");
        for len in 0..file.base_bytes {
            assert!(matches!(
                decode(&file.bytes[..len], Limits::default()),
                Err(DecodeError::Truncated { .. })
            ));
        }
        (file.base_bytes..file.base_bytes + 40).for_each(|len| assert!(error(len) < 1.0));
    }
}

#[test]
fn a_budget_of_bytes_is_kept() {
    let surface = surface(rings(2), 3);
    let file = encode(&surface, &Settings::new(Precision::Bytes(3000))).unwrap();
    assert_eq!(file.bytes.len(), 3000);
    assert!(decode(&file.bytes, Limits::default()).is_ok());
}

#[test]
fn a_budget_beyond_all_precision_gives_the_finest_file() {
    let mut surface = surface(rings(1), 1);
    // So far off that steps are at their finest long before the file is as precise as numbers are.
    surface.positions.iter_mut().for_each(|point| *point += 1e7);
    let file = encode(&surface, &Settings::new(Precision::Bytes(1 << 30))).unwrap();
    assert!(matches!(
        encode(&surface, &Settings::new(Precision::Step(file.step / 2.0))),
        Err(EncodeError::Range { .. })
    ));
    assert_eq!(decode(&file.bytes, Limits::default()).unwrap().positions.len(), surface.positions.len());
}

#[test]
fn coordinates_that_overflow_are_refused_on_both_ways() {
    let good = surface(rings(1), 1);
    let refused = encode(&good, &Settings::new(Precision::Step(1e308))).unwrap_err();
    assert_eq!(refused, EncodeError::Precision { asked: 1e308 });
    let file = encode(&good, &Settings::new(Precision::Step(0.1))).unwrap();
    let (mut header, length) = header::Header::parse(&file.bytes).unwrap();
    header.step = f64::MAX;
    let bytes = [&header.to_bytes(), &file.bytes[length..]].concat();
    assert!(matches!(decode(&bytes, Limits::default()), Err(DecodeError::Malformed { .. })));
}

#[test]
fn a_level_is_what_the_wavelets_leave_there() {
    use crate::surface_wavelet::{forward, inverse_to_level};
    let unit = 2_f64.powi(-16);
    for surface in cases() {
        let hierarchy = Hierarchy::from(&arranged(&surface).unwrap());
        for basis in Basis::ALL {
            // The integer transform has other weights than the real one where it is biquintic.
            let about = if basis == Basis::Biquintic { 0.1 } else { 64.0 * unit };
            let precisions = [(Precision::Step(1e-3), 1e-9), (Precision::Lossless { unit }, about)];
            for (precision, most) in precisions {
                let file = encode(&surface, &Settings { basis, ..Settings::new(precision) }).unwrap();
                let mut coefficients = decode(&file.bytes, Limits::default()).unwrap().positions;
                forward(basis, &hierarchy, &mut coefficients);
                for level in 0..=surface.levels {
                    let decoded = decode_level(&file.bytes, level, Limits::default()).unwrap();
                    let mut points = coefficients[..hierarchy.vertices(level as usize)].to_vec();
                    inverse_to_level(basis, &hierarchy, level as usize, &mut points);
                    assert_eq!((decoded.levels, decoded.positions.len()), (level, points.len()));
                    let off = points.iter().zip(&decoded.positions).map(|(one, other)| one.distance(*other));
                    let off = off.fold(0.0, f64::max);
                    assert!(off < most, "{basis:?} {precision:?} {level}: {off}");
                }
                let levels = surface.levels;
                let missing = decode_level(&file.bytes, levels + 1, Limits::default());
                assert_eq!(missing.unwrap_err(), DecodeError::Level { asked: levels + 1, levels });
            }
        }
    }
}

#[test]
fn a_level_takes_no_more_than_its_bytes() {
    let surface = surface(rings(6), 4);
    let lossless = Settings::new(Precision::Lossless { unit: 2_f64.powi(-12) });
    let by_regions = Settings { faces_per_region: NonZeroU32::new(8), ..Settings::new(Precision::Rms(1e-4)) };
    let of = |bytes: &[u8], level| decode_level(bytes, level, Limits::default()).unwrap();
    let check = |settings, level, length: fn(&Encoded) -> usize| {
        let file = encode(&surface, &settings).unwrap();
        let beginning = &file.bytes[..length(&file)];
        assert!(beginning.len() < file.bytes.len());
        assert!(of(beginning, level) == of(&file.bytes, level));
        assert!(of(beginning, 4) != of(&file.bytes, 4));
    };
    check(lossless, 1, |file| file.bytes.len() * 4 / 5);
    check(by_regions, 2, |file| {
        let (header, length) = header::Header::parse(&file.bytes).unwrap();
        length + (header.base.len + header.parts[0].len) as usize
    });
}

#[test]
fn a_region_is_as_in_the_whole() {
    let surface = surface(rings(6), 4);
    let settings = Settings { faces_per_region: NonZeroU32::new(8), ..Settings::new(Precision::Rms(1e-4)) };
    let file = encode(&surface, &settings).unwrap();
    let whole = decode(&file.bytes, Limits::default()).unwrap();
    assert_eq!(regions(&file.bytes), Ok(12));
    for region in [0, 5, 11] {
        let (part, faces) = decode_region(&file.bytes, region, 4, Limits::default()).unwrap();
        let (mut same, mut others) = (0, 0);
        let mesh = whole.level(4);
        for (quad, corners) in mesh.faces().iter().enumerate() {
            let equal = corners
                .iter()
                .all(|&corner| part.positions[corner as usize] == whole.positions[corner as usize]);
            // All faces of the base have four sides, so that each makes 4^4 quads.
            if faces.contains(&(quad / 256)) {
                assert!(equal, "{region} {quad}");
                same += 1;
            } else {
                others += usize::from(!equal);
            }
        }
        assert_eq!(same, 8 * 256);
        assert!(others > 4 * 8 * 256);
    }
    assert!(matches!(decode_region(&file.bytes, 12, 4, Limits::default()), Err(DecodeError::Region { .. })));
}

#[test]
fn hostile_bytes_are_refused_or_decoded() {
    let surface = surface(open_and_sharp(), 2);
    let file = encode(&surface, &Settings::new(Precision::Rms(1e-2))).unwrap();
    for place in 0..file.bytes.len() {
        let mut damaged = file.bytes.clone();
        damaged[place] ^= 0x55;
        assert!(decode(&damaged, Limits::default()).is_err(), "{place}");
        // A file cut behind the damage has no checksum of what is there.
        damaged.truncate(file.bytes.len() - 1);
        let _ = decode(&damaged, Limits::default());
    }
    let refused = decode(&file.bytes, Limits { vertices: 10 }).unwrap_err();
    assert!(matches!(refused, DecodeError::TooLarge { limit: 10, .. }));
}

/// Behind right checksums: whatever the base mesh says, and more levels than it was made for.
#[test]
fn hostile_bytes_with_right_checksums_too() {
    let mut seed = 1_u64;
    let mut byte = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 56) as u8
    };
    let mut decoded = 0;
    for round in 0..400_u32 {
        let base: Vec<u8> = (0..round % 40).map(|_| byte()).collect();
        let part: Vec<u8> = (0..round % 60).map(|_| byte()).collect();
        let header = header::Header {
            basis: Basis::ALL[round as usize % 3],
            lossless: byte() % 2 == 0,
            has_features: byte() % 2 == 0,
            levels: u32::from(byte() % 6),
            tangential: byte() % 16,
            step: 1e-3,
            numbers: [u32::from(byte() % 8) + 1, u32::from(byte() % 4) + 1, u32::from(byte() % 16) + 1],
            faces_per_region: None,
            base: header::Segment::of(&base),
            parts: vec![header::Segment::of(&part)],
        };
        let bytes = [header.to_bytes(), base, part].concat();
        decoded += usize::from(decode(&bytes, Limits { vertices: 1 << 16 }).is_ok());
    }
    assert!(decoded < 400);
}

#[test]
fn bad_surfaces_are_refused() {
    let good = surface(rings(1), 1);
    let settings = Settings::new(Precision::Step(0.1));
    let mut bad = good.clone();
    bad.positions[3].y = f64::NAN;
    assert_eq!(encode(&bad, &settings).unwrap_err(), EncodeError::NotFinite { vertex: 3 });
    let mut bad = good.clone();
    bad.positions.pop();
    assert!(matches!(encode(&bad, &settings), Err(EncodeError::Points { .. })));
    let mut bad = good.clone();
    bad.base.push(&[0, 1, 7]);
    assert!(matches!(encode(&bad, &settings), Err(EncodeError::Points { .. } | EncodeError::Side { .. })));
    let empty = SubdivisionSurface {
        base: Faces::default(),
        features: Features::default(),
        levels: 0,
        positions: vec![],
    };
    assert_eq!(encode(&empty, &settings).unwrap_err(), EncodeError::Empty);
    for asked in [0.0, -1.0, f64::NAN] {
        assert!(matches!(
            encode(&good, &Settings::new(Precision::Rms(asked))),
            Err(EncodeError::Precision { .. })
        ));
    }
    assert!(matches!(encode(&good, &Settings::new(Precision::Step(1e-12))), Err(EncodeError::Range { .. })));
}
