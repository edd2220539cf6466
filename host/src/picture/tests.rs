use super::*;
use crate::mesh::{Faces, PolygonMesh, TriangleMesh};

/// Two squares in front of each other, seen from z: the smaller one is nearer and turned away.
fn squares() -> PolygonMesh {
    let square = |side: f64, z: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Point::new(x * side, y * side, z))
    };
    let positions = [square(1.0, 0.0), square(0.4, 0.5)].concat();
    let faces: [&[u32]; 2] = [&[0, 1, 2, 3], &[7, 6, 5, 4]];
    PolygonMesh::new(positions, Faces::from_iter(faces))
}

fn plain() -> Picture {
    let camera = Camera { towards: Point::Z, ..Camera::default() };
    Picture { size: [100, 80], camera, ..Picture::default() }
}

fn share(image: &Image, color: [u8; 3]) -> f64 {
    let found = image.pixels.as_chunks::<3>().0.iter().filter(|pixel| **pixel == color).count();
    found as f64 / (image.size[0] * image.size[1]) as f64
}

#[test]
fn the_nearer_face_is_seen_and_backs_have_their_own_hue() {
    let picture = plain();
    let image = picture.draw(&squares(), None);
    assert_eq!(image.pixel([0, 0]), picture.background.0);
    let [front, back] = [image.pixel([50, 10]), image.pixel([50, 40])];
    assert!(front[2] > front[0] && back[0] > back[2] + 50, "{front:?} {back:?}");
    // The larger square fills the height but for the border; the smaller one is nearer, so larger than 0.16 of it.
    let filled = 1.0 - share(&image, picture.background.0);
    assert!((filled - 0.94 * 0.94 * 0.8).abs() < 0.02, "{filled}");
    assert!(share(&image, back) > 0.17 * filled && share(&image, back) < 0.25 * filled);
}

#[test]
fn lines_run_along_sides_and_not_along_cuts() {
    let sheet =
        PolygonMesh::new(squares().positions[..4].to_vec(), Faces::from_iter([[0, 1, 2, 3].as_slice()]));
    let [without, with] = [0.0, 2.0].map(|line_width| Picture { line_width, ..plain() }.draw(&sheet, None));
    for step in 15..65 {
        assert_eq!(without.pixel([step + 10, step]), with.pixel([step + 10, step]));
        assert_eq!(without.pixel([step + 10, 79 - step]), with.pixel([step + 10, 79 - step]));
    }
    let darker = |x, y| with.pixel([x, y])[0] < without.pixel([x, y])[0];
    assert!(darker(50, 3) && darker(50, 76) && darker(13, 40) && darker(86, 40));
}

#[test]
fn patches_have_colors_and_threads_do_not_matter() {
    let draw = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| plain().draw(&squares(), Some(&[0, 3])))
    };
    let image = draw(1);
    assert_eq!(image, draw(3));
    let red = image.pixel([50, 10]);
    assert!(red[0] > 2 * red[1] && red[1] == red[2], "{red:?}");
}

#[test]
fn strange_meshes_are_drawn_too() {
    let empty = plain().draw(&TriangleMesh::default(), None);
    assert_eq!(share(&empty, [255; 3]), 1.0);
    let at = |x: f64| Point::new(x, 1e-3 * x, 2.0);
    let flat =
        TriangleMesh { positions: vec![at(0.0), at(1.0), at(1.0)], triangles: vec![[0, 1, 2], [0, 0, 0]] };
    assert_eq!(share(&plain().draw(&flat, None), [255; 3]), 1.0);
    let one_pixel = Picture { size: [1, 1], ..plain() }.draw(&squares(), None);
    assert_ne!(one_pixel.pixel([0, 0]), [255; 3]);
}

#[test]
fn files_hold_the_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("squares.png");
    let image = plain().draw(&squares(), None);
    image.write_png(&path).unwrap();
    let mut reader =
        png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, image.pixels);
    let error = image.write_png(&folder.path().join("none/a.png")).unwrap_err();
    assert!(error.to_string().contains("cannot write"), "{error}");
}
