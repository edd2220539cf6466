//! Any bytes as a header: of a codestream, of a stream of rows, of a stream of slabs. What is read is written again,
//! by code that shares nothing with the kernel, and must be the same bytes: a header has one form.

use conformance::oracle::coder as oracle;
use wavelift_kernel::stream::{RowPlan, SlabPlan};
use wavelift_kernel::{DecodeError, Header, Plan, SampleType, Wavelet};

/// Reads `bytes` as each kind of header.
pub fn check(bytes: &[u8]) {
    codestream(bytes);
    let rows = RowPlan::parse(bytes).map(|(plan, len)| {
        let fields = fields(plan.sample_type(), plan.levels(), plan.wavelet());
        (written(b"wS\x02\x00", fields, &[plan.width(), plan.strip()]), len)
    });
    same(bytes, rows, |bytes| RowPlan::parse(bytes).err());
    let slabs = SlabPlan::parse(bytes).map(|(slabs, len)| {
        let plan = slabs.plan();
        let fields = fields(slabs.sample_type(), plan.levels(), plan.wavelet());
        (written(b"wS\x02\x01", fields, &plan.extent().axes()), len)
    });
    same(bytes, slabs, |bytes| SlabPlan::parse(bytes).err());
}

/// As the oracle reads it, where it knows the storage.
fn codestream(bytes: &[u8]) {
    let parsed = Header::parse(bytes);
    let read = oracle::Header::parse(bytes);
    match (&parsed, read) {
        (Ok(header), Ok(read)) => assert_eq!(header.encoded_bytes(), read.total_bytes() as u64),
        (Ok(header), Err(error)) => {
            let has_own_page = header.is_dense() || header.slack().is_some() || is_tabled(bytes);
            assert!(has_own_page, "the oracle refuses it: {error:?}");
        }
        (Err(error), Ok(_)) => panic!("the oracle reads it, the kernel says {error}"),
        (Err(_), Err(_)) => {}
    }
    let rewritten = parsed.map(|header| {
        let header = rewrite(&header, bytes);
        let len = header.len();
        (header, len)
    });
    same(bytes, rewritten, |bytes| Header::parse(bytes).err());
}

/// What was read is the beginning of `bytes`, and no shorter beginning can be read.
fn same(
    bytes: &[u8],
    rewritten: Result<(Vec<u8>, usize), DecodeError>,
    error: impl Fn(&[u8]) -> Option<DecodeError>,
) {
    let Ok((header, len)) = rewritten else { return };
    assert_eq!((bytes.get(..len), len), (Some(&header[..]), header.len()), "a second form of a header");
    assert_eq!(error(&bytes[..len]), None, "what follows a header is looked at");
    for shorter in 0..len {
        assert_eq!(error(&bytes[..shorter]), Some(DecodeError::Truncated), "{shorter} of {len} bytes");
    }
}

/// Whether the storage field says that a codestream is tabled.
fn is_tabled(bytes: &[u8]) -> bool {
    matches!(bytes.get(3), Some(3 | 4 | 6))
}

/// Whether it says that it is light.
fn is_light(bytes: &[u8]) -> bool {
    bytes.get(3) == Some(&5)
}

/// The header of a codestream from what it says of itself; how the steps of a lattice shrink, from its byte.
fn rewrite(header: &Header, bytes: &[u8]) -> Vec<u8> {
    let plan: Plan = header.plan();
    let storage = match (header.is_stored(), header.is_dense(), header.slack()) {
        (true, ..) => 0x80,
        (_, true, _) => 1,
        (.., Some(_)) => 2,
        _ if is_tabled(bytes) || is_light(bytes) => bytes[3],
        _ => 0,
    };
    let mut fields = fields(header.sample_type(), plan.levels(), plan.wavelet());
    if header.slack().is_some() {
        fields[0] &= 0x0F;
    }
    let mut out = written(&[b'w', b'L', 2, storage], fields, &plan.extent().axes());
    if let Some(slack) = header.slack() {
        push_number(&mut out, slack);
        out.push(bytes[out.len()]);
    }
    let levels = if header.is_stored() { 0 } else { plan.levels() };
    let finer =
        (0..levels).rev().map(|level| header.bytes_to_level(level) - header.bytes_to_level(level + 1));
    let mut lengths = Vec::new();
    finer.for_each(|length| push_number(&mut lengths, u32::try_from(length).expect("a segment")));
    let rest = header.bytes_to_level(levels) - (out.len() + lengths.len()) as u64;
    let coarsest = (1..=5).find_map(|digits| {
        let mut number = Vec::new();
        push_number(&mut number, u32::try_from(rest.checked_sub(digits)?).ok()?);
        (number.len() as u64 == digits).then_some(number)
    });
    out.extend(coarsest.expect("the length of the coarsest segment"));
    out.extend(lengths);
    out
}

/// The byte of type and wavelet, and the levels.
fn fields(sample_type: SampleType, levels: u8, wavelet: Wavelet) -> [u8; 2] {
    let code = |found: Option<usize>| u8::try_from(found.expect("one of them")).expect("a few");
    let wavelet = if levels == 0 { 0 } else { code(Wavelet::ALL.iter().position(|w| *w == wavelet)) + 1 };
    [wavelet << 4 | code(SampleType::ALL.iter().position(|t| *t == sample_type)), levels]
}

fn written(beginning: &[u8], fields: [u8; 2], numbers: &[u32]) -> Vec<u8> {
    let mut bytes = [beginning, &fields].concat();
    numbers.iter().for_each(|&number| push_number(&mut bytes, number));
    bytes
}

/// Seven bits to a byte, least significant first.
fn push_number(bytes: &mut Vec<u8>, mut number: u32) {
    while number > 0x7F {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}
