//! Rows that come one after another.

use conformance::oracle::noise::Noise;
use conformance::streams::{Pieces, decode, encode};
use wavelift_kernel::stream::RowPlan;
use wavelift_kernel::{SampleType, Wavelet};

#[test]
fn every_extent_comes_back() {
    let mut noise = Noise::new(1);
    for wavelet in Wavelet::ALL {
        for width in [1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31, 33] {
            for height in [0, 1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31, 33, 60] {
                for levels in 0..=7 {
                    let plan = RowPlan::new(wavelet, width, levels, SampleType::I16).unwrap();
                    let samples: Vec<i32> = (0..width * height)
                        .map(|i| (noise.bits() % 64) as i32 + (i / 3) as i32 % 200)
                        .collect();
                    let stream = encode(&plan, &samples, Pieces::Whole);
                    let (back, end) = decode(&stream, samples.len() + 1, Pieces::Whole);
                    assert_eq!(end, Ok(0), "{wavelet} {width} {height} {levels}");
                    assert!(back == samples, "{wavelet} {width} {height} {levels}");
                }
            }
        }
    }
}
