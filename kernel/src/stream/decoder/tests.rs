use super::super::RowEncoder;
use super::*;
use crate::{SampleType, Wavelet};

/// Rows tried: more than it takes until as much waits as ever does.
const ROWS: usize = if cfg!(miri) { 20 } else { 400 };

const WIDTH: usize = 2;

/// The most pairs that wait on each level of a long stream.
fn most_waiting(plan: &RowPlan) -> [usize; 4] {
    let mut memory: heapless::Vec<i32, 8192> = heapless::Vec::new();
    memory.resize(plan.decoder_memory_len(), 0).unwrap();
    let (mut codec, mut stream) = (RowCodec::NEW, heapless::Vec::<u8, 4096>::new());
    let mut encoder = RowEncoder::new(plan, &mut codec, &mut memory).unwrap();
    for _ in 0..ROWS {
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
    let mut most = [0; 4];
    let mut decoder = RowDecoder::new(plan, &mut codec, &mut memory).unwrap();
    loop {
        if decoder.left > 0 {
            decoder.left = 0;
        }
        for (most, level) in most.iter_mut().zip(0..) {
            *most = decoder.inverse.waiting(level).max(*most);
        }
        if !matches!(decoder.phase, Phase::Code(..)) && decoder.pull() {
            continue;
        }
        let taken = decoder.reader.fill(rest);
        rest = &rest[taken..];
        match decoder.proceed().unwrap().unwrap() {
            Phase::Done => return most,
            phase => decoder.phase = phase,
        }
    }
}

#[test]
fn as_many_pairs_wait_as_there_is_room_for() {
    for wavelet in Wavelet::ALL {
        for levels in 1..=if cfg!(miri) { 1 } else { 4 } {
            let plan = RowPlan::new(wavelet, 2, levels, SampleType::U8).unwrap();
            let room =
                [0, 1, 2, 3].map(|level| if level < levels { plan.held(Role::Decoder, level) } else { 0 });
            assert_eq!(most_waiting(&plan), room, "{wavelet} {levels}");
        }
    }
}
