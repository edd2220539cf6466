use super::super::RowEncoder;
use super::*;
use crate::coder::Above;
use crate::{SampleType, Wavelet};

/// More rows than it takes until as much waits as ever does.
const ROWS: usize = if cfg!(miri) { 20 } else { 400 };

const WIDTH: usize = 2;

/// The most pairs that wait on each level of a stream of so many rows, and the most coefficients that are on their way, in
/// 32nds of a row of samples.
///
/// Where energies look at the two pairs before, these wait when the next is decoded: nothing has changed them.
fn most_waiting(plan: &RowPlan, rows: usize) -> ([usize; 4], usize) {
    let mut memory: heapless::Vec<i32, 8192> = heapless::Vec::new();
    memory.resize(plan.decoder_memory_len().max(plan.encoder_memory_len()), 0).unwrap();
    let (mut codec, mut stream) = (RowCodec::NEW, heapless::Vec::<u8, 4096>::new());
    let mut encoder = RowEncoder::new(plan, &mut codec, &mut memory).unwrap();
    for _ in 0..rows {
        let mut output = [0; 64];
        let step = encoder.step(&[3; WIDTH], &mut output).unwrap();
        assert_eq!((step.consumed, step.status), (WIDTH, Status::NeedInput));
        stream.extend_from_slice(&output[..step.produced]).unwrap();
    }
    encoder.finish().unwrap();
    let mut output = [0; 512];
    let step = encoder.step(&[], &mut output).unwrap();
    assert_eq!(step.status, Status::Done);
    stream.extend_from_slice(&output[..step.produced]).unwrap();

    let (_, header) = RowPlan::parse(&stream).unwrap();
    let mut rest = &stream[header..];
    let (mut most, mut most_on_the_way, mut pairs) = ([0; 4], 0, [0; 4]);
    let mut decoder = RowDecoder::new(plan, &mut codec, &mut memory).unwrap();
    loop {
        if decoder.left > 0 {
            decoder.left = 0;
        }
        for (most, level) in most.iter_mut().zip(0..) {
            *most = decoder.inverse.waiting(level).max(*most);
        }
        most_on_the_way = decoder.inverse.on_the_way(plan.levels()).max(most_on_the_way);
        if !matches!(decoder.phase, Phase::Code(..)) && decoder.pull() {
            continue;
        }
        if let Phase::Code(Some(Pair { level, .. }), 1, cursor) = decoder.phase
            && cursor.is_first()
            && let Above::Rows(_) = decoder.row(Some(Pair { level, c: 0, d: None }), 1).above
        {
            let known = &mut pairs[usize::from(level)];
            assert!(decoder.inverse.waiting(level) >= 2.min(*known), "{plan:?} {rows} {level}");
            *known += 1;
        }
        let taken = decoder.reader.fill(rest);
        rest = &rest[taken..];
        match decoder.proceed().unwrap().unwrap() {
            Phase::Done => return (most, most_on_the_way),
            phase => decoder.phase = phase,
        }
    }
}

/// What docs/stream.md says, in 32nds of a row.
fn on_the_way_in_three_levels(wavelet: Wavelet) -> usize {
    match wavelet {
        Wavelet::Haar => 8 * 32,
        Wavelet::Quadratic => 27 * 32 + 8,
        Wavelet::Duchaineau => 51 * 32 + 24,
        Wavelet::Linear => 20 * 32 + 8,
        Wavelet::Cubic => 32 * 32 + 16,
        Wavelet::Quintic => 44 * 32 + 24,
    }
}

#[test]
fn as_many_pairs_wait_as_there_is_room_for() {
    for wavelet in Wavelet::ALL {
        for levels in 1..=if cfg!(miri) { 1 } else { 4 } {
            let plan = RowPlan::new(wavelet, 2, levels, SampleType::U8).unwrap();
            let room = [0, 1, 2, 3].map(|level| if level < levels { plan.held(level) } else { 0 });
            let (most, on_the_way) = most_waiting(&plan, ROWS);
            assert_eq!(most, room, "{wavelet} {levels}");
            if levels == 3 && !cfg!(miri) {
                assert_eq!(on_the_way, on_the_way_in_three_levels(wavelet), "{wavelet}");
            }
            for rows in 0..if cfg!(miri) { 5 } else { 100 } {
                let (most, _) = most_waiting(&plan, rows);
                assert!(most.iter().zip(room).all(|(&most, room)| most <= room), "{wavelet} {levels} {rows}");
            }
        }
    }
}
