use super::*;
use crate::{Extent, Plan, SampleType, Wavelet};

/// Samples of a slice, at most.
const MOST: usize = 33 * 33;

type Samples = heapless::Vec<i32, MOST>;

/// Whole-range noise.
fn samples(count: usize) -> Samples {
    let mut seed = 7_u32;
    let noise = core::iter::repeat_with(|| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed ^ seed >> 15).cast_signed()
    });
    noise.take(count).collect()
}

/// Writes every row that the encoder comes to code to its place in Mallat order.
fn coefficients(rows: &RowPlan, plan: &Plan, samples: &[i32]) -> Samples {
    let mut memory: heapless::Vec<i32, 2048> = heapless::Vec::new();
    memory.resize(rows.encoder_memory_len(), 0).unwrap();
    let mut codec = RowCodec::NEW;
    let mut encoder = RowEncoder::new(rows, &mut codec, &mut memory).unwrap();
    let mut found = samples.iter().map(|_| 0).collect::<Samples>();
    // Coded rows of each orientation of each level; of the low-pass part as those of orientation 0.
    let mut coded = [[0; 4]; LEVELS_TRIED];
    let mut rest = samples;
    loop {
        let mut output = [0; 512];
        encoder.give(&mut output);
        match encoder.phase {
            Phase::Fill if !rest.is_empty() => {
                let taken = encoder.fill(rest).unwrap();
                rest = &rest[taken..];
                continue;
            }
            Phase::Fill => encoder.finish().unwrap(),
            Phase::Done => return found,
            Phase::Code(pair, orientation, cursor) if cursor.is_first() => {
                let row = encoder.row(pair, orientation);
                let values: Samples =
                    (0..row.width).map(|x| row.values.get(encoder.memory, x).unwrap()).collect();
                let level = pair.map_or(0, |pair| pair.level);
                let number = &mut coded[usize::from(level)][usize::from(orientation)];
                let resolution = if orientation == 0 { 0 } else { plan.levels().saturating_sub(level) };
                // A level that splits nothing has no subbands of details.
                if !values.is_empty() && (orientation == 0 || resolution > 0) {
                    let mut subbands = plan.subbands(resolution);
                    let subband = subbands.find(|subband| subband.orientation == orientation).unwrap();
                    let start = subband.row(plan, *number, 0);
                    found[start..start + row.width].copy_from_slice(&values);
                }
                *number += 1;
            }
            _ => {}
        }
        encoder.proceed();
    }
}

const LEVELS_TRIED: usize = 8;

#[test]
fn coefficients_are_those_of_the_whole_slice() {
    const SIDES: &[u32] = if cfg!(miri) { &[1, 3] } else { &[1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31, 33] };
    let mut scratch = samples(1024);
    for wavelet in Wavelet::ALL {
        for (width, height) in
            SIDES.iter().flat_map(|&width| SIDES.iter().map(move |&height| (width, height)))
        {
            let extent = Extent::slice(width, height).unwrap();
            // One level more than there are changes nothing.
            for levels in 0..=extent.max_levels() + 1 {
                let plan = Plan::new(wavelet, extent, levels.min(extent.max_levels())).unwrap();
                let rows = RowPlan::new(wavelet, width, levels, SampleType::I32).unwrap();
                let samples = samples(extent.samples());
                let mut expected = samples.clone();
                plan.forward(&mut expected, &mut scratch).unwrap();
                let found = coefficients(&rows, &plan, &samples);
                assert!(found == expected, "{wavelet} {extent} {levels}");
            }
        }
    }
}
