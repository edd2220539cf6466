//! `wavelift surface`: a surface built in one go and step by step, decoded in parts, drawn, compared.

use serde_json::Value;

use crate::run::Folder;

/// Two balls, one of which is cut by the border, as raw bytes: 255 inside, falling off over a few samples.
fn balls([width, height, depth]: [usize; 3]) -> Vec<u8> {
    let value = |[x, y, z]: [f64; 3]| {
        let ball = |[a, b, c]: [f64; 3], radius: f64| {
            radius - ((x - a).powi(2) + (y - b).powi(2) + (z - c).powi(2)).sqrt()
        };
        let inside = ball([11.3, 11.0, 10.6], 7.0).max(ball([27.0, 12.2, 11.1], 6.0));
        (128.0 + 24.0 * inside).clamp(0.0, 255.0) as u8
    };
    let nodes = (0..depth).flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| [x, y, z])));
    nodes.map(|node| value(node.map(|index| index as f64))).collect()
}

const EXTENT: [usize; 3] = [30, 24, 22];
const LAYOUT: &str = "--extent 30x24x22 --type u8";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("balls.raw", balls(EXTENT));
    folder
}

fn number(document: &Value, name: &str) -> f64 {
    document[name].as_f64().unwrap_or_else(|| panic!("{name} in {document}"))
}

#[test]
fn a_surface_is_built_in_one_go() {
    let folder = folder();
    let built = folder
        .run(&format!("surface build balls.raw balls.wsurf --iso 128 --share 0.05 --keep steps {LAYOUT}"))
        .ok();
    assert!(built.stdout().contains("components 2, genus 0, boundary loops 1"), "{}", built.stdout());
    folder.run("surface decode balls.wsurf finest.ply").ok();
    let compared = folder.run("surface compare steps/contour.ply finest.ply --json --samples 5000").json();
    assert!(number(&compared, "rms") < 0.1, "{compared}");
    let whole = folder.read("balls.wsurf").len();
    let mut before = f64::INFINITY;
    for part in [2.5, 1.6, 1.0] {
        folder
            .run(&format!("surface decode balls.wsurf part.ply --bytes {}", (whole as f64 / part) as usize))
            .ok();
        let rms =
            number(&folder.run("surface compare finest.ply part.ply --json --samples 5000").json(), "rms");
        assert!(rms < before, "{rms} of 1/{part} after {before}");
        before = rms;
    }
    assert!(before < 1e-12, "{before}");
    let tables = folder.run("surface tables balls.wsurf --json --pictures pictures --samples 5000").json();
    let errors: Vec<f64> = tables["rows"]
        .as_array()
        .expect("rows")
        .iter()
        .map(|row| number(row, "vertex_rmse_percent"))
        .collect();
    assert!(errors.is_sorted() && errors.len() == 4, "{tables}");
    assert!(folder.read("pictures/20.png").starts_with(b"\x89PNG"));
}

#[test]
fn a_surface_is_built_step_by_step() {
    let folder = folder();
    folder.run(&format!("surface extract balls.raw contour.obj --iso 128 {LAYOUT}")).ok();
    folder.run(&format!("surface distance balls.raw distance.nrrd --iso 128 {LAYOUT}")).ok();
    let base = folder.run("surface base contour.obj base.off --share 0.05 --border distance.nrrd").ok();
    assert!(base.stdout().contains("components 2"), "{}", base.stdout());
    folder.run("surface wrap base.off distance.nrrd exact.wsurf --levels 2 --onto contour.obj").ok();
    folder.run("surface encode exact.wsurf small.wsurf --bytes 1500 --faces-per-region 8").ok();
    assert!(folder.read("small.wsurf").len() <= 1500);
    for mesh in ["a.ply", "a.obj", "a.stl", "a.off", "a.gltf", "a.glb"] {
        folder.run(&format!("surface decode small.wsurf {mesh} --level 1 --limit")).ok();
        folder.run(&format!("surface view-png {mesh} {mesh}.png --size 64x48 --lines")).ok();
    }
    folder.run("surface decode small.wsurf region.ply --region 0").ok();
    folder.run("surface view-png small.wsurf small.png --patches --level 0 --size 64x64").ok();
    let octree = folder.run("surface base distance.nrrd octree.ply --deviation 0.05").ok();
    assert!(octree.stdout().contains("genus 0"), "{}", octree.stdout());
    let compared = folder.run("surface compare contour.obj exact.wsurf --cell 1 --samples 5000").ok();
    assert!(compared.stdout().contains("% of a cell"), "{}", compared.stdout());
}

#[test]
fn meshes_are_built_too() {
    let folder = folder();
    folder.run(&format!("surface extract balls.raw contour.ply --iso 128 {LAYOUT}")).ok();
    let built = folder.run("surface build contour.ply mesh.wsurf --share 0.05 --cells 32 --unit 0.001").ok();
    assert!(built.stdout().contains("components 2, genus 0, boundary loops 1"), "{}", built.stdout());
}

#[test]
fn what_was_asked_for_is_at_fault_and_not_the_file() {
    let folder = folder();
    folder.run(&format!("surface build balls.raw balls.wsurf --iso 128 --share 0.05 {LAYOUT}")).ok();
    folder.run(&format!("surface extract balls.raw contour.ply --iso 128 {LAYOUT}")).ok();
    folder.run(&format!("surface distance balls.raw distance.nrrd --iso 128 {LAYOUT}")).ok();
    let before = folder.everything();
    let build = format!("surface build balls.raw out.wsurf --iso 128 {LAYOUT}");
    let lines = [
        format!("{build} --share 0"),
        format!("{build} --levels 99"),
        format!("{build} --tolerance nan"),
        format!("{build} --rms 0"),
        format!("surface build balls.raw out.ply --iso 128 {LAYOUT}"),
        "surface encode balls.wsurf out.obj".to_owned(),
        "surface encode balls.wsurf out.wsurf --step 1e308".to_owned(),
        "surface encode balls.wsurf out.wsurf --unit 1e-12".to_owned(),
        "surface wrap contour.ply distance.nrrd out.wsurf --levels 40".to_owned(),
        "surface wrap contour.ply distance.nrrd out.glb".to_owned(),
        "surface decode balls.wsurf out.ply --region 0".to_owned(),
        "surface compare balls.wsurf balls.wsurf --cell 0".to_owned(),
        "surface tables balls.wsurf --cell 0".to_owned(),
    ];
    for line in lines {
        folder.run(&line).fails(2, &[]);
    }
    assert_eq!(folder.everything(), before);
    folder.run("surface encode balls.wsurf fine.wsurf --bytes 100000000").ok();
}

#[test]
fn the_wavelet_of_surfaces_is_the_one_that_help_tells() {
    let folder = folder();
    folder.run(&format!("surface build balls.raw balls.wsurf --iso 128 --share 0.05 {LAYOUT}")).ok();
    let help = folder.run("surface encode --help");
    assert!(help.stdout().contains("Wavelets [default: bicubic]"), "{}", help.stdout());
    for how in ["--unit 0.01", "--rms 0.01"] {
        folder.run(&format!("surface encode balls.wsurf default.wsurf {how}")).ok();
        folder.run(&format!("surface encode balls.wsurf named.wsurf {how} --wavelet bicubic")).ok();
        assert_eq!(folder.read("default.wsurf"), folder.read("named.wsurf"), "{how}");
    }
}

#[test]
fn faults_are_told_and_nothing_is_written() {
    let folder = folder();
    folder.write("broken.wsurf", b"wavelift? no");
    folder.write("broken.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n");
    folder.write("empty.obj", b"");
    let before = folder.everything();
    let usage = [
        format!("surface build balls.raw out.wsurf {LAYOUT}"),
        format!("surface extract balls.raw out.txt --iso 128 {LAYOUT}"),
        "surface build empty.obj out.wsurf --iso 3".to_owned(),
        format!("surface build balls.raw out.wsurf --iso 300 {LAYOUT}"),
        format!("surface extract balls.raw out.ply --iso -5 {LAYOUT}"),
        format!("surface distance balls.raw out.nrrd --iso -5 {LAYOUT}"),
        "surface distance balls.raw out.nrrd --limit 0".to_owned(),
        "surface view-png empty.obj out.png --size 0x9".to_owned(),
    ];
    for line in usage {
        folder.run(&line).fails(2, &[]);
    }
    let data = [
        "surface decode broken.wsurf out.ply".to_owned(),
        "surface build broken.ply out.wsurf".to_owned(),
        "surface build empty.obj out.wsurf".to_owned(),
        "surface base empty.obj out.ply".to_owned(),
        "surface compare empty.obj empty.obj".to_owned(),
        "surface tables broken.wsurf".to_owned(),
    ];
    for line in data {
        folder.run(&line).fails(3, &[]);
    }
    for step in ["extract balls.raw out.ply", "distance balls.raw out.nrrd", "build balls.raw out.wsurf"] {
        let slice = folder.run(&format!("surface {step} --iso 128 --extent 720x22x1 --type u8"));
        slice.fails(3, &["720x22x1"]);
    }
    folder.run("surface decode missing.wsurf out.ply").fails(4, &["missing.wsurf"]);
    assert_eq!(folder.everything(), before);
}

#[test]
fn what_is_read_is_not_overwritten() {
    let folder = folder();
    folder.run(&format!("convert balls.raw v.nhdr {LAYOUT}")).silent();
    folder.run("convert v.nhdr d.nrrd").silent();
    for inner in ["steps", "pictures"] {
        std::fs::create_dir(folder.path(inner)).expect("the folder takes folders");
    }
    for name in ["m.ply", "m.mesh", "s.wsurf", "s.ply", "steps/contour.ply", "pictures/5.png", "g.bin"] {
        folder.write(name, b"what it holds does not come to pass");
    }
    folder.write(
        "g.gltf",
        br#"{ "asset": { "version": "2.0" }, "buffers": [{ "uri": "g.bin", "byteLength": 9 }] }"#,
    );
    folder.write("r.ply", balls(EXTENT));
    folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let before = folder.everything();
    for (line, file) in [
        ("build v.nhdr v.raw --iso 128", "v.raw"),
        ("build v.nhdr v.nhdr --iso 128", "v.nhdr"),
        ("build steps/contour.ply o.wsurf --keep steps", "steps/contour.ply"),
        ("build g.gltf g.bin", "g.bin"),
        (&format!("extract r.ply r.ply --iso 128 {LAYOUT}"), "r.ply"),
        ("distance v.nhdr v.raw --iso 128", "v.raw"),
        ("distance v.nhdr v.mhd --iso 128", "v.raw"),
        ("distance m.ply ./m.ply", "m.ply"),
        ("distance g.gltf g.bin", "g.bin"),
        ("base m.ply m.ply", "m.ply"),
        (&format!("base t.obj r.ply --border r.ply {LAYOUT}"), "r.ply"),
        ("wrap m.mesh d.nrrd m.mesh", "m.mesh"),
        ("wrap g.gltf d.nrrd g.bin", "g.bin"),
        ("encode s.wsurf s.wsurf", "s.wsurf"),
        ("decode s.ply s.ply", "s.ply"),
        ("view-png m.ply m.ply", "m.ply"),
        ("view-png s.wsurf s.wsurf", "s.wsurf"),
        ("tables pictures/5.png --pictures pictures", "pictures/5.png"),
    ] {
        folder.run(&format!("surface {line}")).fails(2, &["would overwrite", file]);
    }
    folder.run("tables v.nhdr --svg v.raw").fails(2, &["would overwrite", "v.raw"]);
    assert!(folder.everything() == before);
}
