//! Slices that come one after another, coded in slabs.

use conformance::corrupt::Damage;
use conformance::effort::Effort;
use conformance::inputs::Input;
use conformance::lent;
use conformance::oracle::noise::Noise;
use conformance::slabs::{Memory, decode, encode};
use wavelift_kernel::stream::{RowError, RowPlan, SlabEncoder, SlabPlan, Status};
use wavelift_kernel::{
    Codec, DecodeError, Effort as Lent, EncodeError, Extent, Header, LengthError, Malformed, Plan, PlanError,
    SampleType, Slice, Wavelet,
};

fn plan_of(axes: [u32; 3], levels: u8) -> SlabPlan {
    let extent = Extent::new(axes).expect("a small extent");
    SlabPlan::new(Wavelet::Linear, extent, levels, SampleType::I16).expect("a plan of slabs")
}

fn waves(axes: [u32; 3]) -> Vec<i32> {
    let input = Input::Waves { periods: [9, 13, 7], amplitude: 900, offset: -5 };
    input.generate(Extent::new(axes).expect("a small extent")).expect("a generator")
}

#[test]
fn any_number_of_slices_comes_back_in_any_pieces() {
    for (axes, levels) in [([9, 7, 4], 3), ([1, 1, 8], 3), ([16, 1, 3], 2), ([5, 6, 1], 0), ([3, 2, 5], 3)] {
        let plan = plan_of(axes, levels);
        for slices in 1..=11 {
            let samples = waves([axes[0], axes[1], slices]);
            let stream = encode(&plan, Effort::Fast, &samples, 4096);
            for piece in [1, 2, 7, 4096] {
                assert_eq!(encode(&plan, Effort::Fast, &samples, piece), stream, "{axes:?} {slices} {piece}");
                assert_eq!(decode(&stream, piece), (samples.clone(), Ok(0)), "{axes:?} {slices} {piece}");
            }
            for effort in Effort::ALL {
                let stream = encode(&plan, effort, &samples, 64);
                assert_eq!(decode(&stream, 64), (samples.clone(), Ok(0)), "{axes:?} {slices} {effort:?}");
            }
        }
        assert_eq!(decode(&encode(&plan, Effort::Fast, &[], 1), 1), (vec![], Ok(0)));
    }
}

/// Each slab is a codestream as the codec makes it, behind its length.
#[test]
fn slabs_are_codestreams() {
    let plan = plan_of([9, 7, 4], 2);
    let samples = waves([9, 7, 10]);
    let stream = encode(&plan, Effort::Fast, &samples, 100);
    assert_eq!(stream[..9], [0x77, 0x53, 2, 1, 0x43, 2, 9, 7, 4]);
    let mut rest = &stream[9..];
    for slices in [4, 4, 2] {
        let (low, high) = (usize::from(rest[0] & 0x7F), usize::from(rest[1]));
        assert!(rest[0] >= 0x80 && high < 0x80, "a number of two bytes");
        let (slab, after) = rest[2..].split_at(low | high << 7);
        let header = Header::parse(slab).unwrap();
        let extent = Extent::brick(9, 7, slices).unwrap();
        assert_eq!(header.plan(), Plan::new(Wavelet::Linear, extent, 2).unwrap());
        rest = after;
    }
    assert_eq!(rest, [0]);
}

/// In the upper half there is nothing, in the lower every slice is the same noise: in 16,384 bytes, if it is found out.
#[test]
fn slabs_are_predicted_as_suits_all_of_their_rows() {
    let (plan, mut noise) = (plan_of([128, 64, 32], 0), Noise::new(4));
    let slice: Vec<i32> =
        (0..128 * 64).map(|i| if i < 128 * 32 { 0 } else { noise.bits() as i8 as i32 }).collect();
    let samples = slice.repeat(32);
    let stream = encode(&plan, Effort::Fast, &samples, 4096);
    assert!(stream.len() < 16_384, "{}", stream.len());
}

/// A slab is what the codec makes of it with the same effort, but no slab is dense.
#[test]
fn slabs_are_coded_with_any_effort_but_dense() {
    let (axes, slices) = ([128, 128, 1], 3);
    let plan = plan_of(axes, 0);
    let samples = waves([axes[0], axes[1], slices]);
    let end = encode(&plan, Effort::Fast, &[], 64);
    let stream_of = |effort| {
        let mut stream = end[..end.len() - 1].to_vec();
        for slice in samples.chunks(plan.samples_len()) {
            let slab = lent::encode(&mut { Codec::NEW }, effort, &plan.plan(), SampleType::I16, slice);
            let length = u16::try_from(slab.len()).expect("few bytes");
            assert!((1 << 7..1 << 14).contains(&length), "a number of two bytes: {length}");
            stream.extend([(length & 0x7F) as u8 | 0x80, (length >> 7) as u8]);
            stream.extend(slab);
        }
        [&stream[..], &[0]].concat()
    };
    for effort in Effort::ALL {
        let stream = encode(&plan, effort, &samples, 999);
        assert!(stream == stream_of(effort), "{effort:?}");
        assert!(decode(&stream, 999) == (samples.clone(), Ok(0)), "{effort:?}");
    }
    assert!(encode(&plan, Effort::Dense, &samples, 999) == stream_of(Effort::Default));
    assert_eq!(decode(&stream_of(Effort::Dense), 999), (vec![], Err(Malformed::Slab.into())));
}

#[test]
fn what_is_not_as_it_should_be_is_refused() {
    let extent = Extent::brick(9, 7, 4).unwrap();
    let levels = SlabPlan::new(Wavelet::Haar, extent, 5, SampleType::U8);
    assert_eq!(levels, Err(PlanError::TooManyLevels { max: 4 }));
    let large = Extent::brick(1 << 15, 1 << 15, 1).unwrap();
    assert_eq!(SlabPlan::new(Wavelet::Haar, large, 1, SampleType::I32), Err(PlanError::ExtentTooLarge));

    let plan = plan_of([4, 3, 2], 1);
    let (mut memory, mut codec) = (Memory::new(&plan), Codec::NEW);
    memory.bytes = lent::Lent::new(plan.bytes_len() - 1, 0);
    let short = SlabEncoder::new(&plan, &mut codec, Lent::Fast, memory.lend()).map(|_| ());
    let expected = plan.bytes_len();
    let error = LengthError { slice: Slice::Bytes, expected, actual: expected - 1 };
    assert_eq!(short, Err(EncodeError::Length(error)));

    let mut memory = Memory::new(&plan);
    let mut encoder = SlabEncoder::new(&plan, &mut codec, Lent::Fast, memory.lend()).unwrap();
    let step = encoder.step(&[5; 7], &mut [0; 64]).unwrap();
    assert_eq!((step.consumed, step.status), (7, Status::NeedInput));
    assert_eq!(encoder.step(&[1 << 15], &mut []), Err(RowError::SampleOutOfRange { index: 0 }));
    assert_eq!(encoder.finish(), Err(RowError::UnfinishedRow { missing: 5 }));

    let samples = waves([4, 3, 4]);
    let stream = encode(&plan, Effort::Fast, &samples, 64);
    let with = |at: usize, byte: u8| {
        let mut bytes = stream.clone();
        bytes[at] = byte;
        decode(&bytes, 64).1
    };
    assert_eq!(with(3, 0), Err(DecodeError::OtherCodec));
    assert_eq!(RowPlan::parse(&stream), Err(DecodeError::OtherCodec));
    assert_eq!(with(6, 0), Err(Malformed::Extent.into()));
    assert_eq!(with(5, 9), Err(Malformed::Levels.into()));
    // Other slabs than the header says; slabs shorter and longer than their codestreams.
    assert_eq!(with(8, 1), Err(Malformed::Slab.into()));
    assert_eq!(with(5, 2), Err(Malformed::Slab.into()));
    assert_eq!(with(9, stream[9] - 1), Err(Malformed::Slab.into()));
    assert_eq!(with(9, stream[9] + 1), Err(Malformed::Slab.into()));
    assert_eq!(with(9, 0x7F), Err(Malformed::Slab.into()));
    for len in 0..stream.len() {
        let (back, end) = decode(&stream[..len], 5);
        assert_eq!(end, Err(DecodeError::Truncated));
        assert_eq!(back, samples[..back.len()]);
    }
}

#[test]
fn damage_does_no_harm() {
    let stream = encode(&plan_of([9, 7, 4], 2), Effort::Fast, &waves([9, 7, 10]), 100);
    let other = encode(&plan_of([4, 3, 2], 1), Effort::Fast, &waves([4, 3, 4]), 64);
    let mut noise = Noise::new(9);
    for damage in Damage::ALL.into_iter().cycle().take(2000) {
        let mut bytes = stream.clone();
        damage.inflict(&mut bytes, &other, &mut noise);
        assert_eq!(decode(&bytes, 1), decode(&bytes, 300));
    }
}
