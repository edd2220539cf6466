//! Any extent, wavelet, levels, effort, type and samples, there and back.

use arbitrary::{Result, Unstructured};
use conformance::effort::Effort;
use conformance::lent::{decode_any, encode, encode_near, encode_within};
use conformance::reference::{lattice, low_pass};
use wavelift_kernel::{Codec, EncodeError, Extent, Header, Near, Plan, SampleType, Wavelet};

/// Takes a case from `bytes`, and checks what encoder and decoder promise of it.
pub fn check(bytes: &[u8]) {
    // Too few bytes make no case.
    let _ = Case::take(&mut Unstructured::new(bytes)).map(|case| case.check());
}

/// What is encoded, and how.
struct Case {
    extent: Extent,
    sample_type: SampleType,
    /// Wavelet, levels, effort; or how far samples may be off.
    form: Form,
    /// Bytes of output in a second try, in 1/256 of those that suffice.
    room: u8,
    samples: Vec<i32>,
}

enum Form {
    Coded(Effort, Plan),
    Lattice { slack: u32 },
}

impl Case {
    fn take(data: &mut Unstructured<'_>) -> Result<Self> {
        let axes = match data.int_in_range(1..=3)? {
            1 => [data.int_in_range(1..=400)?, 1, 1],
            2 => [data.int_in_range(1..=40)?, data.int_in_range(1..=40)?, 1],
            _ => [data.int_in_range(1..=13)?, data.int_in_range(1..=13)?, data.int_in_range(1..=13)?],
        };
        let extent = Extent::new(axes).expect("a small extent");
        let sample_type = *data.choose(&SampleType::ALL)?;
        let wavelet = *data.choose(&Wavelet::ALL)?;
        let plan = |levels| Plan::new(wavelet, extent, levels).expect("levels that it has");
        let form = match data.int_in_range(0..=4)? {
            0 => Form::Coded(Effort::Fast, plan(data.int_in_range(0..=extent.max_levels())?)),
            1 => Form::Coded(Effort::Default, plan(data.int_in_range(0..=extent.max_levels())?)),
            2 => Form::Coded(Effort::Dense, plan(0)),
            3 => Form::Coded(Effort::Light, plan(data.int_in_range(0..=extent.max_levels())?)),
            _ => Form::Lattice { slack: data.arbitrary::<u32>()? >> data.int_in_range(0..=31)? },
        };
        let room = data.arbitrary()?;
        let samples = crate::samples::fill(data, sample_type, extent.samples())?;
        Ok(Self { extent, sample_type, form, room, samples })
    }

    fn check(&self) {
        match &self.form {
            Form::Coded(effort, plan) => self.check_coded(*effort, plan),
            Form::Lattice { slack } => self.check_lattice(*slack),
        }
    }

    fn check_coded(&self, effort: Effort, plan: &Plan) {
        let mut codec = Box::new(Codec::NEW);
        let bytes = encode(&mut codec, effort, plan, self.sample_type, &self.samples);
        let header = Header::parse(&bytes).expect("a codestream");
        assert_eq!((header.plan(), header.sample_type()), (*plan, self.sample_type));
        assert_eq!(header.encoded_bytes(), bytes.len() as u64);
        for level in 0..=plan.levels() {
            let expected = low_pass(plan, &self.samples, level);
            assert_eq!(decode_any(&bytes, level, &header), Ok(expected), "level {level}");
        }
        let room = bytes.len() * usize::from(self.room) / 256;
        let (encoded, left) = encode_within(&mut codec, effort, plan, self.sample_type, &self.samples, room);
        assert_eq!((encoded, left), (Err(EncodeError::OutputFull), self.samples.clone()), "{room} bytes");
    }

    fn check_lattice(&self, slack: u32) {
        let near = Near { extent: self.extent, sample_type: self.sample_type, slack };
        let bytes = encode_near(near, &self.samples);
        let header = Header::parse(&bytes).expect("a codestream");
        let decoded = decode_any(&bytes, 0, &header).expect("what was encoded");
        let far = self.samples.iter().zip(&decoded).find(|(sample, decoded)| {
            self.value(**sample).abs_diff(self.value(**decoded)) > u64::from(slack)
        });
        assert_eq!(far, None, "further off than {slack}");
        if header.slack().is_some() {
            for level in 0..=header.plan().levels() {
                let expected = lattice(&header.plan(), &decoded, level);
                assert_eq!(decode_any(&bytes, level, &header), Ok(expected), "level {level}");
            }
        }
    }

    /// What a sample stands for.
    fn value(&self, sample: i32) -> i64 {
        if self.sample_type == SampleType::U32 { sample.cast_unsigned().into() } else { sample.into() }
    }
}
