//! What a build lacks is refused, by name, wherever it is asked for. `cargo xtask test` runs this with several sets of
//! features; with all of them nothing is refused.

use wavelift_kernel::{
    Codec, DecodeError, Dense, Effort, EncodeError, Extent, Feature, Header, Lattice, Near, Plan, PlanError,
    SampleType, Training, Wavelet, max_encoded_len,
};

const SIDE: u32 = 16;
const SAMPLES: usize = 16 * 16 * 16;

fn extent() -> Extent {
    Extent::new([SIDE; 3]).unwrap()
}

fn samples() -> Vec<i32> {
    (0..SAMPLES as i32).map(|i| (i % 16 * 3 + i / 16 % 16 * 5 + i / 256 * 7 + i * i % 5) % 256).collect()
}

/// Encodes and decodes; what either says if it refuses.
fn round_trip(effort: Effort<'_>, plan: &Plan) -> Result<(), EncodeError> {
    let mut bytes = vec![0; max_encoded_len(extent(), SampleType::U8).unwrap()];
    let (mut codec, mut dense) = (Codec::NEW, Box::new(Dense::NEW));
    let (mut coded, mut scratch) = (samples(), vec![0; effort.scratch_len(plan)]);
    let len = codec.encode(effort, plan, SampleType::U8, &mut coded, &mut scratch, &mut bytes)?;
    let mut decoded = vec![0; SAMPLES];
    scratch.resize(Header::parse(&bytes[..len]).unwrap().scratch_len(), 0);
    codec.decode_dense(&mut dense, &bytes[..len], 0, &mut decoded, &mut scratch).unwrap();
    assert_eq!(decoded, samples());
    Ok(())
}

/// What a build says of the encoder of a part.
fn refused(feature: Feature) -> Result<(), EncodeError> {
    if feature.is_built() { Ok(()) } else { Err(EncodeError::NotBuilt(feature)) }
}

#[test]
fn wavelets() {
    for wavelet in Wavelet::ALL {
        let feature = Feature::Wavelet(wavelet);
        match Plan::new(wavelet, extent(), 2) {
            Ok(plan) if feature.is_built() => {
                assert_eq!(round_trip(Effort::Fast, &plan), refused(Feature::Adaptive));
                assert_eq!(round_trip(Effort::Light, &plan), refused(Feature::Light));
            }
            planned => {
                assert!(!feature.is_built());
                assert_eq!(planned, Err(PlanError::NotBuilt(feature)));
            }
        }
    }
}

#[test]
fn efforts() {
    let plan = Plan::new(Wavelet::Haar, extent(), 0).unwrap();
    assert_eq!(round_trip(Effort::Fast, &plan), refused(Feature::Adaptive));
    assert_eq!(round_trip(Effort::Light, &plan), refused(Feature::Light));
    let (mut training, mut dense) = (Box::new(Training::NEW), Box::new(Dense::NEW));
    assert_eq!(round_trip(Effort::Default(&mut training), &plan), refused(Feature::Trained));
    assert_eq!(round_trip(Effort::Dense(&mut dense, &mut training), &plan), refused(Feature::Dense));
}

#[test]
fn lattices() {
    let (mut lattice, mut bytes) = (Box::new(Lattice::NEW), vec![0; 8192]);
    let mut scratch = vec![0; Lattice::encoding_scratch_len(extent())];
    let near = Near { extent: extent(), sample_type: SampleType::U8, slack: 1 };
    let encoded = lattice.encode(near, &mut samples(), &mut scratch, &mut bytes);
    if Feature::Lattice.is_built() {
        let mut decoded = vec![0; SAMPLES];
        lattice.decode(&bytes[..encoded.unwrap()], &mut decoded, &mut scratch).unwrap();
        assert!(decoded.iter().zip(samples()).all(|(a, b)| a.abs_diff(b) <= 1));
    } else {
        assert_eq!(encoded, Err(EncodeError::NotBuilt(Feature::Lattice)));
    }
}

/// Headers as any build reads them, up to what it lacks.
#[test]
fn codestreams_of_other_builds() {
    // Magic, version, storage, type and wavelet, levels, extent, and bytes of segments.
    let stored = |wavelet: u8| [b'w', b'L', 2, 0x80, wavelet << 4, 1, 4, 4, 4, 64];
    let parsed = |bytes: &[u8]| Header::parse(bytes).map(|_| ());
    for (wavelet, number) in Wavelet::ALL.into_iter().zip(1..) {
        refuses(parsed(&stored(number)), Feature::Wavelet(wavelet));
    }
    refuses(parsed(&[b'w', b'L', 2, 0, 0, 0, 4, 4, 4, 0]), Feature::Adaptive);
    refuses(parsed(&[b'w', b'L', 2, 5, 0, 0, 4, 4, 4, 0]), Feature::Light);
    refuses(parsed(&[b'w', b'L', 2, 1, 0, 0, 4, 4, 4, 0]), Feature::Dense);
    refuses(parsed(&[b'w', b'L', 2, 2, 0, 1, 4, 4, 4, 1, 0, 0, 0]), Feature::Lattice);
    // One segment, whose first three bits name trained predictors.
    let trained = [b'w', b'L', 2, 0, 0, 0, 4, 4, 4, 1, 5 << 5];
    let Ok(header) = Header::parse(&trained) else { return };
    let mut codec = Codec::NEW;
    let decoded = codec.decode(&trained, &mut [0; 64], &mut vec![0; header.scratch_len()]);
    let refusal = Err(DecodeError::NotBuilt(Feature::Trained));
    assert_eq!(decoded.map(|_| ()) == refusal, !Feature::Trained.is_built());
}

#[cfg(feature = "stream")]
#[test]
fn streams_of_other_builds() {
    use wavelift_kernel::stream::{RowPlan, SlabPlan};
    for (wavelet, number) in Wavelet::ALL.into_iter().zip(1..) {
        let feature = Feature::Wavelet(wavelet);
        let rows = RowPlan::new(wavelet, SIDE, 2, SampleType::U8).map(|_| ());
        assert_eq!(rows, if feature.is_built() { Ok(()) } else { Err(PlanError::NotBuilt(feature)) });
        assert!(RowPlan::new(wavelet, SIDE, 0, SampleType::U8).is_ok());
        // Magic, version, kind, type and wavelet, levels, then width and strip, or the extent.
        let header = |kind| [b'w', b'S', 2, kind, number << 4, 1, 4, 4, 4];
        refuses(RowPlan::parse(&header(0)).map(|_| ()), feature);
        refuses(SlabPlan::parse(&header(1)).map(|_| ()), feature);
    }
}

/// Slabs are refused before the first slice comes.
#[cfg(feature = "slabs")]
#[test]
fn slabs() {
    use wavelift_kernel::stream::{SlabEncoder, SlabMemory, SlabPlan};
    let plan = SlabPlan::new(Wavelet::Haar, extent(), 0, SampleType::U8).unwrap();
    let (mut codec, mut samples) = (Codec::NEW, vec![0; plan.samples_len()]);
    let (mut scratch, mut bytes) = (vec![0; plan.scratch_len()], vec![0; plan.bytes_len()]);
    let mut begin = |effort: Effort<'_>| {
        let memory = SlabMemory { samples: &mut samples, scratch: &mut scratch, bytes: &mut bytes };
        SlabEncoder::new(&plan, &mut codec, effort, memory).map(|_| ())
    };
    assert_eq!(begin(Effort::Light), refused(Feature::Light));
    assert_eq!(begin(Effort::Fast), refused(Feature::Adaptive));
    let (mut training, mut dense) = (Box::new(Training::NEW), Box::new(Dense::NEW));
    assert_eq!(begin(Effort::Default(&mut training)), refused(Feature::Trained));
    assert_eq!(begin(Effort::Dense(&mut dense, &mut training)), refused(Feature::Trained), "none is dense");
}

/// No build decodes a dense slab, so that none sends the caller for another.
#[cfg(feature = "slabs")]
#[test]
fn dense_slabs() {
    use wavelift_kernel::Malformed;
    use wavelift_kernel::stream::{SlabDecoder, SlabMemory, SlabPlan};
    // Lattices too, of one level.
    for slab in [&[b'w', b'L', 2, 1, 0, 0, 4, 4, 1, 0][..], &[b'w', b'L', 2, 2, 0, 1, 4, 4, 1, 1, 0, 0, 0]] {
        let plan = SlabPlan::new(Wavelet::Haar, Extent::slice(4, 4).unwrap(), 0, SampleType::U8).unwrap();
        let (mut codec, mut samples) = (Codec::NEW, [0; 16]);
        let (mut scratch, mut bytes) = (vec![0; plan.scratch_len()], vec![0; plan.bytes_len()]);
        let memory = SlabMemory { samples: &mut samples, scratch: &mut scratch, bytes: &mut bytes };
        let mut decoder = SlabDecoder::new(&plan, &mut codec, memory).unwrap();
        let stream = [&[slab.len() as u8], slab].concat();
        let taken = decoder.step(&stream, &mut [0; 16]).unwrap().consumed;
        assert_eq!(decoder.step(&stream[taken..], &mut [0; 16]), Err(Malformed::Slab.into()));
    }
}

fn refuses(parsed: Result<(), DecodeError>, feature: Feature) {
    let refusal = DecodeError::NotBuilt(feature);
    assert_eq!(parsed, if feature.is_built() { Ok(()) } else { Err(refusal) });
    assert_eq!(refusal.to_string(), format!("built without the feature {feature}"));
}
