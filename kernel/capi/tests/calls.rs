//! The functions as C calls them, pointer by pointer: what they write comes back, and what they refuse is untouched.
//!
//! Small, so that Miri checks every access: `cargo +nightly miri test --package wavelift-capi`.
#![expect(
    clippy::undocumented_unsafe_blocks,
    clippy::multiple_unsafe_ops_per_block,
    reason = "all is unsafe here, and safe for one reason: every pointer is to memory of its test, as long as it says"
)]

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use wavelift_capi::*;

const PLAN: WaveliftPlan = WaveliftPlan { extent: [7, 5, 3], wavelet: 4, levels: 2, sample_type: 3 };
const SAMPLES: usize = 7 * 5 * 3;

/// Memory for a state, as C has it: anything may be in there.
fn memory<T>() -> Box<MaybeUninit<T>> {
    Box::new_uninit()
}

fn samples() -> Vec<i32> {
    (0..SAMPLES).map(|index| i32::try_from(index * index * 37 % 211).unwrap() - 100).collect()
}

/// Pointers to memory, taken once, so that it is lent as C lends it.
fn lent(samples: &mut [i32], scratch: &mut [i32]) -> WaveliftLent {
    WaveliftLent {
        samples: samples.as_mut_ptr(),
        samples_len: samples.len(),
        scratch: scratch.as_mut_ptr(),
        scratch_len: scratch.len(),
    }
}

/// The encoders that are lent memory for training, or none.
type Encode = unsafe extern "C" fn(
    *mut WaveliftCodec,
    *mut WaveliftTraining,
    *const WaveliftPlan,
    *const WaveliftLent,
    *mut u8,
    *mut usize,
) -> WaveliftError;

/// The encoder that never trains, as one of them.
unsafe extern "C" fn encode_light(
    codec: *mut WaveliftCodec,
    _: *mut WaveliftTraining,
    plan: *const WaveliftPlan,
    lent: *const WaveliftLent,
    out: *mut u8,
    out_len: *mut usize,
) -> WaveliftError {
    unsafe { wavelift_encode_light(codec, plan, lent, out, out_len) }
}

#[test]
fn a_brick_comes_back() {
    let (mut codec, mut training) = (memory::<WaveliftCodec>(), memory::<WaveliftTraining>());
    let mut scratch = vec![0; unsafe { wavelift_scratch_len(&PLAN) }];
    // Bricks as small as this one have no tables.
    let encoders: [Encode; 3] = [wavelift_encode, wavelift_encode_tabled, encode_light];
    for (encode, trains) in encoders.into_iter().flat_map(|encode| [(encode, false), (encode, true)]) {
        let training = if trains { training.as_mut_ptr() } else { null_mut() };
        let (mut given, mut back) = (samples(), vec![0; SAMPLES]);
        let mut out = vec![0; unsafe { wavelift_max_encoded_len(&PLAN) }];
        let mut len = out.len();
        let error = unsafe {
            let lent = lent(&mut given, &mut scratch);
            encode(codec.as_mut_ptr(), training, &PLAN, &lent, out.as_mut_ptr(), &mut len)
        };
        assert_eq!(error, WaveliftError::Ok);
        let mut header = MaybeUninit::uninit();
        let header = unsafe {
            assert_eq!(wavelift_header_parse(out.as_ptr(), len, header.as_mut_ptr()), WaveliftError::Ok);
            header.assume_init()
        };
        assert_eq!(header.plan, PLAN);
        let error = unsafe {
            wavelift_decode(codec.as_mut_ptr(), out.as_ptr(), len, 0, &lent(&mut back, &mut scratch))
        };
        assert_eq!((error, back), (WaveliftError::Ok, samples()));
    }
}

#[test]
fn a_dense_brick_and_a_lattice_come_back() {
    let plan = WaveliftPlan { wavelet: 0, levels: 0, ..PLAN };
    let (mut codec, mut training) = (memory::<WaveliftCodec>(), memory::<WaveliftTraining>());
    let (mut dense, mut lattice) = (memory::<WaveliftDense>(), memory::<WaveliftLattice>());
    let lens = unsafe { [wavelift_dense_scratch_len(&plan), wavelift_near_scratch_len(&plan)] };
    let mut scratch = vec![0; lens.into_iter().max().unwrap()];
    for near in [false, true] {
        let (mut given, mut back) = (samples(), vec![0; SAMPLES]);
        let mut out = vec![0; unsafe { wavelift_max_encoded_len(&plan) }];
        let mut len = out.len();
        let (encoded, decoded) = unsafe {
            let (codec, dense, lattice) = (codec.as_mut_ptr(), dense.as_mut_ptr(), lattice.as_mut_ptr());
            let from = lent(&mut given, &mut scratch);
            let bytes = out.as_mut_ptr();
            let encoded = if near {
                wavelift_encode_near(lattice, &plan, 0, &from, bytes, &mut len)
            } else {
                wavelift_encode_dense(codec, training.as_mut_ptr(), dense, &plan, &from, bytes, &mut len)
            };
            let to = lent(&mut back, &mut scratch);
            let decoded = if near {
                wavelift_decode_near(lattice, bytes, len, 0, &to)
            } else {
                wavelift_decode_dense(codec, dense, bytes, len, 0, &to)
            };
            (encoded, decoded)
        };
        assert_eq!((encoded, decoded, back), (WaveliftError::Ok, WaveliftError::Ok, samples()));
    }
}

/// Calls `step` until the stream is complete, each time with three more elements of input and room for five of output.
fn drain<I, O: Copy + Default>(
    input: &[I],
    mut step: impl FnMut(*const I, usize, *mut O, usize, *mut WaveliftStep) -> WaveliftError,
    mut finish: impl FnMut(),
) -> Vec<O> {
    let (mut output, mut at) = (vec![], 0);
    loop {
        let mut piece = [O::default(); 5];
        let room = input.len().min(at + 3) - at;
        let mut done = MaybeUninit::uninit();
        let from = input[at..].as_ptr();
        assert_eq!(step(from, room, piece.as_mut_ptr(), piece.len(), done.as_mut_ptr()), WaveliftError::Ok);
        let WaveliftStep { consumed, produced, status } = unsafe { done.assume_init() };
        at += consumed;
        output.extend_from_slice(&piece[..produced]);
        match status {
            WaveliftStatus::Done => return output,
            WaveliftStatus::NeedInput if at == input.len() => finish(),
            _ => {}
        }
    }
}

#[test]
fn rows_come_back_in_pieces() {
    let plan = WaveliftRowPlan { width: 7, strip: 4, wavelet: 4, levels: 2, sample_type: 3 };
    let mut codec = memory::<WaveliftRowCodec>();
    let codec = codec.as_mut_ptr();
    let (mut encoder, mut decoder) = (memory::<WaveliftRowEncoder>(), memory::<WaveliftRowDecoder>());
    let (encoder, decoder) = (encoder.as_mut_ptr(), decoder.as_mut_ptr());
    unsafe {
        let mut memory = vec![0; wavelift_row_encoder_memory_len(&plan)];
        let (lent, len) = (memory.as_mut_ptr(), memory.len());
        assert_eq!(wavelift_row_encoder_begin(encoder, codec, &plan, lent, len), WaveliftError::Ok);
        let step = |from, len, to, room, done| wavelift_row_encoder_step(encoder, from, len, to, room, done);
        let finish = || assert_eq!(wavelift_row_encoder_finish(encoder), WaveliftError::Ok);
        let stream: Vec<u8> = drain(&samples(), step, finish);

        let mut parsed = MaybeUninit::uninit();
        let mut header = 0;
        let error =
            wavelift_row_header_parse(stream.as_ptr(), stream.len(), parsed.as_mut_ptr(), &mut header);
        assert_eq!((error, parsed.assume_init()), (WaveliftError::Ok, plan));
        let (least, fast) =
            (wavelift_row_decoder_memory_len(&plan), wavelift_row_decoder_fast_memory_len(&plan));
        assert!(least < fast);
        for len in [least, fast] {
            let mut memory = vec![0; len];
            let error = wavelift_row_decoder_begin(decoder, codec, &plan, memory.as_mut_ptr(), len);
            assert_eq!(error, WaveliftError::Ok);
            let step =
                |from, len, to, room, done| wavelift_row_decoder_step(decoder, from, len, to, room, done);
            let back: Vec<i32> = drain(&stream[header..], step, || panic!("the stream is whole"));
            assert_eq!(back, samples());
        }
    }
}

/// Begins to encode slabs, of each effort.
type Begin = unsafe fn(
    *mut WaveliftSlabEncoder,
    *mut WaveliftCodec,
    *mut WaveliftTraining,
    (*const WaveliftPlan, *const WaveliftLent),
    (*mut u8, usize),
) -> WaveliftError;

const BEGINS: [Begin; 5] = unsafe {
    [
        |encoder, codec, _, (plan, lent), (room, len)| {
            wavelift_slab_encoder_begin(encoder, codec, null_mut(), plan, lent, room, len)
        },
        |encoder, codec, training, (plan, lent), (room, len)| {
            wavelift_slab_encoder_begin(encoder, codec, training, plan, lent, room, len)
        },
        |encoder, codec, _, (plan, lent), (room, len)| {
            wavelift_slab_encoder_begin_light(encoder, codec, plan, lent, room, len)
        },
        |encoder, codec, _, (plan, lent), (room, len)| {
            wavelift_slab_encoder_begin_tabled(encoder, codec, null_mut(), plan, lent, room, len)
        },
        |encoder, codec, training, (plan, lent), (room, len)| {
            wavelift_slab_encoder_begin_tabled(encoder, codec, training, plan, lent, room, len)
        },
    ]
};

#[test]
fn slabs_come_back_in_pieces() {
    let plan = WaveliftPlan { extent: [7, 5, 2], ..PLAN };
    let (mut codec, mut training) = (memory::<WaveliftCodec>(), memory::<WaveliftTraining>());
    let (codec, training) = (codec.as_mut_ptr(), training.as_mut_ptr());
    let (mut encoder, mut decoder) = (memory::<WaveliftSlabEncoder>(), memory::<WaveliftSlabDecoder>());
    let (encoder, decoder) = (encoder.as_mut_ptr(), decoder.as_mut_ptr());
    unsafe {
        let (mut slab, mut scratch) =
            (vec![0; wavelift_samples_len(&plan)], vec![0; wavelift_scratch_len(&plan)]);
        let mut bytes = vec![0; wavelift_max_encoded_len(&plan)];
        let (lent, bytes, room) = (lent(&mut slab, &mut scratch), bytes.as_mut_ptr(), bytes.len());
        for begin in BEGINS {
            assert_eq!(begin(encoder, codec, training, (&plan, &lent), (bytes, room)), WaveliftError::Ok);
            let step =
                |from, len, to, room, done| wavelift_slab_encoder_step(encoder, from, len, to, room, done);
            let finish = || assert_eq!(wavelift_slab_encoder_finish(encoder), WaveliftError::Ok);
            let stream: Vec<u8> = drain(&samples(), step, finish);

            let mut parsed = MaybeUninit::uninit();
            let mut header = 0;
            let error =
                wavelift_slab_header_parse(stream.as_ptr(), stream.len(), parsed.as_mut_ptr(), &mut header);
            assert_eq!((error, parsed.assume_init()), (WaveliftError::Ok, plan));
            let error = wavelift_slab_decoder_begin(decoder, codec, &plan, &lent, bytes, room);
            assert_eq!(error, WaveliftError::Ok);
            let step =
                |from, len, to, room, done| wavelift_slab_decoder_step(decoder, from, len, to, room, done);
            let back: Vec<i32> = drain(&stream[header..], step, || panic!("the stream is whole"));
            assert_eq!(back, samples());
        }
    }
}

#[test]
fn dense_slabs_are_told_as_such() {
    let plan = WaveliftPlan { extent: [4, 4, 1], wavelet: 0, levels: 0, sample_type: 0 };
    let (mut codec, mut decoder) = (memory::<WaveliftCodec>(), memory::<WaveliftSlabDecoder>());
    let (codec, decoder) = (codec.as_mut_ptr(), decoder.as_mut_ptr());
    let (mut slab, mut scratch, mut room) = ([0; 16], [0; 64], [0; 64]);
    let (lent, room, len) = (lent(&mut slab, &mut scratch), room.as_mut_ptr(), room.len());
    // The length of a slab, and the header of a dense codestream.
    let (stream, mut samples) = ([10, b'w', b'L', 2, 1, 0, 0, 4, 4, 1, 0], [0; 16]);
    let mut step = MaybeUninit::<WaveliftStep>::uninit();
    unsafe {
        assert_eq!(
            wavelift_slab_decoder_begin(decoder, codec, &plan, &lent, room, 8),
            WaveliftError::BytesTooShort
        );
        assert_eq!(wavelift_slab_decoder_begin(decoder, codec, &plan, &lent, room, len), WaveliftError::Ok);
        let mut decode = |bytes: &[u8]| {
            let (from, count) = (bytes.as_ptr(), bytes.len());
            wavelift_slab_decoder_step(decoder, from, count, samples.as_mut_ptr(), 16, step.as_mut_ptr())
        };
        // All but the length is looked at once it is there.
        assert_eq!(decode(&stream[..5]), WaveliftError::Ok);
        assert_eq!(decode(&stream[5..]), WaveliftError::MalformedSlab);
    }
}

#[test]
fn what_is_not_begun_null_or_lent_twice_is_refused() {
    let mut encoder = memory::<WaveliftRowEncoder>();
    let mut codec = memory::<WaveliftCodec>();
    let (mut given, mut scratch) = (samples(), vec![0; unsafe { wavelift_scratch_len(&PLAN) }]);
    let mut len = SAMPLES;
    unsafe {
        encoder.as_mut_ptr().write_bytes(0, 1);
        let error = wavelift_row_encoder_finish(encoder.as_mut_ptr());
        assert_eq!(error, WaveliftError::NotBegun);
        let lent = lent(&mut given, &mut scratch);
        let out = lent.samples.cast::<u8>();
        let error = wavelift_encode(codec.as_mut_ptr(), null_mut(), &PLAN, &lent, out, &mut len);
        assert_eq!(error, WaveliftError::Overlap);
        let error = wavelift_encode(null_mut(), null_mut(), null(), &lent, out, &mut len);
        assert_eq!(error, WaveliftError::NullPointer);
    }
    assert_eq!((given, len), (samples(), SAMPLES));
}
