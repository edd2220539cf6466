use std::path::Path;

use super::*;
use crate::mesh::{Faces, Point};

/// A cube of quads, one of which is cut in two, with coordinates that no `f32` holds.
fn cube(side: f64) -> PolygonMesh {
    let positions = (0..8).map(|corner| {
        Point::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2)) * side
    });
    let faces: [&[u32]; 7] =
        [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7], &[1, 7, 5]];
    PolygonMesh::new(positions.collect(), Faces::from_iter(faces))
}

fn bytes_of(mesh: &impl Surface, format: MeshFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_to(mesh, format, &mut bytes).unwrap();
    bytes
}

/// Reads bytes that come without a name.
fn parse_any(bytes: &[u8]) -> Result<PolygonMesh, MeshFault> {
    parse(bytes, Path::new("mesh.obj"))
}

fn fault(text: &str) -> MeshFault {
    parse_any(text.as_bytes()).unwrap_err()
}

/// Triangles by the places of their corners, so that the order of vertices does not matter.
fn places(mesh: &TriangleMesh) -> Vec<[[f64; 3]; 3]> {
    let place = |corner: u32| mesh.positions[corner as usize].to_array();
    mesh.triangles.iter().map(|triangle| triangle.map(place)).collect()
}

#[test]
fn every_format_gives_back_what_was_written() {
    for side in [0.5, 0.1] {
        let mesh = cube(side);
        for format in MeshFormat::ALL {
            let back = parse_any(&bytes_of(&mesh, format)).unwrap();
            match format {
                MeshFormat::Ply | MeshFormat::PlyText | MeshFormat::Obj | MeshFormat::Off => {
                    assert_eq!(back, mesh, "{format:?}");
                }
                MeshFormat::StlText => assert_eq!(places(&back.triangulated()), places(&mesh.triangulated())),
                _ => {
                    let mut rounded = mesh.triangulated();
                    rounded.positions.iter_mut().for_each(|point| *point = point.as_vec3().as_dvec3());
                    assert_eq!(places(&back.triangulated()), places(&rounded), "{format:?}");
                    assert_eq!(back.positions.len(), 8);
                }
            }
        }
    }
}

/// Whatever the bytes are, a mesh comes out that is one, or an error that says something.
fn must_return(bytes: &[u8]) {
    match parse_any(bytes) {
        Ok(mesh) => assert!(mesh.positions.iter().all(|point| point.is_finite()) && !mesh.faces().is_empty()),
        Err(fault) => assert!(!fault.to_string().is_empty()),
    }
}

#[test]
fn no_damage_is_taken_badly() {
    for format in MeshFormat::ALL {
        let bytes = bytes_of(&cube(0.5), format);
        for end in 0..bytes.len() {
            must_return(&bytes[..end]);
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            for flip in [0x01, 0x10, 0x80, 0xFF] {
                damaged[at] = bytes[at] ^ flip;
                must_return(&damaged);
            }
            damaged[at] = b'9';
            must_return(&damaged);
        }
    }
}

#[test]
fn binary_files_that_are_cut_short_say_so() {
    for format in [MeshFormat::Ply, MeshFormat::Glb] {
        let bytes = bytes_of(&cube(0.5), format);
        let cut = parse(&bytes[..bytes.len() - 1], Path::new("mesh")).unwrap_err();
        assert!(matches!(cut, MeshFault::Truncated { .. } | MeshFault::Header { .. }), "{cut}");
    }
    let bytes = bytes_of(&cube(0.5), MeshFormat::Stl);
    let cut = parse(&bytes[..bytes.len() - 1], Path::new("mesh.stl")).unwrap_err();
    assert_eq!(cut, MeshFault::Truncated { within: "triangles", byte: bytes.len() - 1 });
    let longer = [bytes.as_slice(), b"x"].concat();
    assert!(matches!(parse(&longer, Path::new("mesh.stl")), Err(MeshFault::Header { .. })));
}

#[test]
fn promises_take_no_memory() {
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n\
               property float x\nproperty float y\nproperty float z\nend_header\n";
    assert!(matches!(fault(ply), MeshFault::Truncated { within: "vertices", .. }));
    let hollow = "ply\nformat ascii 1.0\nelement nothing 18446744073709551615\nend_header\n";
    assert_eq!(fault(hollow), MeshFault::NoFaces { vertices: 0 });
    let list =
        "ply\nformat ascii 1.0\nelement face 1\nproperty list double int vertex_index\nend_header\n1e18 1";
    assert!(matches!(fault(list), MeshFault::Truncated { .. }));
    assert!(matches!(fault("OFF 18446744073709551615 9 0"), MeshFault::Truncated { within: "vertices", .. }));
    assert!(matches!(fault("OFF 1 1 0\n0 0 0\n4000000000 0 0 0"), MeshFault::Line { number: 3, .. }));
    // Sixteen nodes that place a hundred million triangles each, which are no bytes at all.
    let gltf = r#"{"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 300000000, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 3, "byteStride": 12}],
        "buffers": [{"byteLength": 3, "uri": "data:;base64,AAAA"}]}"#;
    assert_eq!(fault(gltf), MeshFault::Header { what: "an array reaches beyond its buffer".to_owned() });
}

#[test]
fn faults_name_their_place() {
    assert_eq!(
        fault("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4"),
        MeshFault::Index { face: 0, index: 3, vertices: 3 }
    );
    assert_eq!(fault("v 0 0 0\nf -1 -1 -2"), MeshFault::Index { face: 0, index: -1, vertices: 1 });
    assert_eq!(fault("v 0 0 0\nf 1 1"), MeshFault::Sides { face: 0, sides: 2 });
    assert_eq!(fault("v 0 0 0\nv 0 nan 0"), MeshFault::NotFinite { vertex: 1 });
    assert_eq!(fault("# nothing but\nv 0 0 0"), MeshFault::NoFaces { vertices: 1 });
    let MeshFault::Line { number, text, .. } = fault("v 0 0 0\nv 0 0") else { panic!("no line") };
    assert_eq!((number, text.as_str()), (2, "\"v 0 0\""));
    assert!(matches!(fault("v 0 0 0\nf 1 0 1"), MeshFault::Line { number: 2, .. }));
    assert!(matches!(fault("ply\nformat ascii 1.0\nelement vertex x"), MeshFault::Line { number: 3, .. }));
    assert!(matches!(fault("4OFF\n0 0 0"), MeshFault::Line { number: 1, .. }));
    assert!(matches!(
        fault("solid\nfacet\nouter loop\nvertex 0 0 0\nvertx"),
        MeshFault::Line { number: 5, .. }
    ));
    assert_eq!(parse(b"", Path::new("mesh")), Err(MeshFault::UnknownFormat));
    assert_eq!(parse(b"", Path::new("mesh.obj")), Err(MeshFault::NoFaces { vertices: 0 }));
    let draco = r#"{"extensionsRequired": ["KHR_draco_mesh_compression"]}"#;
    assert!(matches!(fault(draco), MeshFault::Unsupported { .. }));
}

#[test]
fn text_files_of_others_are_read() {
    let obj = "o thing\r\nv 0 0 0 1.0\r\nv 1 0 0\r\nv 1 1 0 # third\r\nv 0 1 0\r\nvn 0 0 1\r\n\
               f 1/1/1 2//1 -2/3 \\\r\n -1\r\nl 1 2\r\n";
    assert_eq!(parse_any(obj.as_bytes()).unwrap().faces().get(0), [0, 1, 2, 3]);
    let off = "# made by hand\nCOFF\n\n3 1 0\n0 0 0 255 0 0\n1 0 0 1 1 1 # red\n0 1 0 0 0 0\n\n3 0 1 2 0.5 0.5 0.5\n";
    assert_eq!(parse_any(off.as_bytes()).unwrap().faces().get(0), [0, 1, 2]);
    let ply = "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty uchar red\nproperty double x\n\
               property double y\nproperty double z\nelement face 1\nproperty list uchar float uv\n\
               property list uchar int vertex_index\nelement edge 1\nproperty int a\nend_header\n\
               9 0 0 0\n9 1 0 0 9 0 1 0\n2 0.5 0.5 3 2 1 0\n7\n";
    let mesh = parse_any(ply.as_bytes()).unwrap();
    assert_eq!(mesh.faces().get(0), [2, 1, 0]);
    assert_eq!(mesh.positions[1], Point::X);
}

#[test]
fn big_endian_ply_is_read() {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty short y\n\
                      property double z\nelement face 1\nproperty list uchar ushort vertex_indices\nend_header\n"
        .to_vec();
    for (x, y, z) in [(1.5_f32, -2_i16, 0.1), (0.0, 0, 0.0), (0.0, 300, 0.0)] {
        bytes.extend(x.to_be_bytes());
        bytes.extend(y.to_be_bytes());
        bytes.extend(f64::to_be_bytes(z));
    }
    bytes.extend([3, 0, 0, 0, 1, 0, 2]);
    let mesh = parse_any(&bytes).unwrap();
    assert_eq!(mesh.positions[0], Point::new(1.5, -2.0, 0.1));
    assert_eq!(mesh.positions[2].y, 300.0);
    assert_eq!(mesh.faces().get(0), [0, 1, 2]);
}

#[test]
fn nodes_place_their_meshes() {
    let floats = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    let buffer: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).chain([0, 1, 2, 3]).collect();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arrays.bin"), buffer).unwrap();
    let text = r#"{"scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1, 2], "translation": [10, 0, 0]}, {"mesh": 0, "scale": [-1, 1, 1]},
            {"mesh": 1, "rotation": [0, 0, 1, 0]}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 9}, "indices": 1, "mode": 5}]},
            {"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}, {"attributes": {"POSITION": 0}, "mode": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 0, "byteOffset": 48, "componentType": 5121, "count": 4, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 52}],
        "buffers": [{"byteLength": 52, "uri": "arrays.bin"}]}"#;
    let path = folder.path().join("scene.gltf");
    std::fs::write(&path, text).unwrap();
    let mesh = read(&path).unwrap();
    let [o, x] = [[10.0, 0.0, 0.0], [9.0, 0.0, 0.0]];
    let expected = [
        [o, [10.0, 1.0, 0.0], x],
        [[10.0, 1.0, 0.0], [9.0, 1.0, 0.0], x],
        [o, x, [10.0, -1.0, 0.0]],
        [o, [10.0, -1.0, 0.0], [9.0, -1.0, 0.0]],
    ];
    let found = places(&mesh);
    for (found, expected) in found.iter().zip(&expected) {
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{found:?} {expected:?}");
        }
    }
    assert_eq!(found.len(), 4);
    let outside = text.replace("arrays.bin", "../arrays.bin");
    assert!(matches!(parse(outside.as_bytes(), &path), Err(MeshFault::Unsupported { .. })));
    let circle = text.replace("\"children\": [1, 2]", "\"children\": [0]");
    assert!(matches!(parse(circle.as_bytes(), &path), Err(MeshFault::Header { .. })));
}

#[test]
fn files_are_named_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cube.ply");
    write(&cube(0.1), &path).unwrap();
    assert_eq!(read_polygons(&path).unwrap(), cube(0.1));
    let named = write(&cube(0.1), &folder.path().join("cube.doc")).unwrap_err();
    assert!(matches!(named, MeshFileError::Name { .. }) && named.to_string().contains("cube.doc"));
    let missing = read(&folder.path().join("none.ply")).unwrap_err();
    assert!(matches!(missing, MeshFileError::Read { .. }));
    assert!(matches!(read(folder.path()), Err(MeshFileError::Read { .. })));
    let huge = cube(1e300);
    let rounded = write(&huge, &folder.path().join("huge.stl")).unwrap_err();
    assert!(matches!(rounded, MeshFileError::Data { cause: MeshFault::NotFinite { vertex: 1 }, .. }));
    assert!(matches!(write(&huge, Path::new("/no/folder/huge.ply")), Err(MeshFileError::Write { .. })));
}
