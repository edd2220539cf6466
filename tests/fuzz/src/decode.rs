//! Any bytes to the decoders, in memory with guards around it.

use conformance::lent::decode_any;
use wavelift_kernel::{Codec, DecodeError, Dense, Header, Lattice};

/// Samples for which memory is taken when bytes ask for it.
const MOST_SAMPLES: usize = 1 << 14;

/// Decodes to every level and one more. What comes out lies in its type, and is the same from as many bytes as the
/// level takes.
pub fn check(bytes: &[u8]) {
    let header = match Header::parse(bytes) {
        Ok(header) => header,
        Err(error) => return assert_eq!(without_memory(bytes), [Err(error); 2].map(Result::<(), _>::from)),
    };
    if header.samples_len(0) > MOST_SAMPLES {
        assert!(without_memory(bytes).iter().all(Result::is_err), "decoded without memory");
        return;
    }
    let levels = header.plan().levels();
    let most = usize::try_from(header.encoded_bytes()).unwrap_or(usize::MAX);
    for level in 0..=levels {
        let Ok(samples) = decode_any(bytes, level, &header) else { continue };
        let range = header.sample_type().range();
        assert!(
            level > 0 || samples.iter().all(|sample| range.contains(sample)),
            "a sample outside its type"
        );
        assert!(bytes.len() <= most, "bytes after the codestream were not noticed");
        let enough = usize::try_from(header.bytes_to_level(level)).expect("no more than there are");
        assert_eq!(
            decode_any(&bytes[..enough], level, &header),
            Ok(samples),
            "level {level} takes more bytes"
        );
    }
    let beyond = decode_any(bytes, levels + 1, &header);
    assert_eq!(beyond, Err(DecodeError::LevelOutOfRange { max: levels }), "a level that is not there");
}

/// What both decoders say of bytes when nothing is lent.
fn without_memory(bytes: &[u8]) -> [Result<(), DecodeError>; 2] {
    let (mut codec, mut dense) = (Box::new(Codec::NEW), Box::new(Dense::NEW));
    let coded = codec.decode_dense(&mut dense, bytes, 0, &mut [], &mut []);
    let lattice = { Lattice::NEW }.decode_to_level(bytes, 0, &mut [], &mut []);
    [coded, lattice].map(|decoded| decoded.map(|_| ()))
}
