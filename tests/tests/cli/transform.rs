//! `transform`: coefficients equal to those of the oracle, and back.

use conformance::oracle::lifting::{self, Psi};

use crate::files::noise;
use crate::run::Folder;

const WAVELETS: [(&str, Psi); 6] = [
    ("haar", Psi::H),
    ("quadratic", Psi::Q),
    ("duchaineau", Psi::D),
    ("linear", Psi::One),
    ("cubic", Psi::Three),
    ("quintic", Psi::Five),
];

fn bytes(values: &[i32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

#[test]
fn coefficients_are_those_of_the_oracle() {
    let folder = Folder::new();
    for (text, extent) in [("37", [37, 1, 1]), ("13x10", [13, 10, 1]), ("9x6x5", [9, 6, 5])] {
        let samples = noise(2 * extent.iter().product::<usize>(), 5);
        folder.write("in.raw", &samples);
        let samples: Vec<i32> =
            samples.as_chunks().0.iter().map(|bytes| i16::from_le_bytes(*bytes).into()).collect();
        for (name, psi) in WAVELETS {
            for levels in [0, 1, 3] {
                let mut coefficients = samples.clone();
                lifting::forward(psi, &mut coefficients, extent, levels);
                let wavelet = format!("--wavelet {name} --levels {levels} --extent {text}");
                folder.run(&format!("transform in.raw out.raw {wavelet} --type i16")).silent();
                assert_eq!(folder.read("out.raw"), bytes(&coefficients), "{wavelet}");
                folder.run(&format!("transform out.raw back.raw {wavelet} --inverse")).silent();
                assert_eq!(folder.read("back.raw"), bytes(&samples), "{wavelet}");
            }
        }
    }
}

#[test]
fn numpy_and_nrrd_files_hold_coefficients_too() {
    let folder = Folder::new();
    folder.write("in.raw", noise(60, 6));
    for name in ["c.npy", "c.nrrd"] {
        folder
            .run(&format!("transform in.raw {name} --wavelet cubic --levels 2 --extent 5x4x3 --type u8"))
            .silent();
        folder.run(&format!("transform {name} back.raw --wavelet cubic --levels 2 --inverse")).silent();
        let samples: Vec<i32> = folder.read("in.raw").into_iter().map(i32::from).collect();
        assert_eq!(folder.read("back.raw"), bytes(&samples), "{name}");
    }
}
