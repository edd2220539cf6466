//! The golden vectors of `vectors/`, each held to everything that is promised of a codestream.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use conformance::effort::Effort;
use conformance::lent::decode_any as decode;
use conformance::oracle::coder::{self, Predictor, shapes};
use conformance::reference::{lattice, low_pass};
use conformance::vectors::{Expect, Manifest, Recipe, Vector, crc32, folder, outcome, sha256};
use wavelift_kernel::{DecodeError, Header, SampleType};

/// A vector that decodes, and what is in it.
struct Golden<'a> {
    entry: &'a Vector,
    bytes: Vec<u8>,
    header: Header,
    /// At every level, the finest first.
    levels: Vec<Vec<i32>>,
}

impl<'a> Golden<'a> {
    fn read(entry: &'a Vector) -> Result<Self, String> {
        let bytes = entry.read()?;
        let header = Header::parse(&bytes).map_err(|error| format!("the header: {error}"))?;
        let decoded = decode(&bytes, 0, &header).map_err(|error| format!("decoding: {error}"))?;
        let plan = header.plan();
        let of_level = |level| match header.slack() {
            Some(_) => lattice(&plan, &decoded, level),
            None => low_pass(&plan, &decoded, level),
        };
        let levels = (0..=plan.levels()).map(of_level).collect();
        Ok(Self { entry, bytes, header, levels })
    }

    /// Bytes that decode to a level.
    fn enough(&self, level: u8) -> usize {
        usize::try_from(self.header.bytes_to_level(level)).expect("a few bytes")
    }

    /// Each level with its samples.
    fn levels(&self) -> impl Iterator<Item = (u8, &Vec<i32>)> {
        (0..).zip(&self.levels)
    }
}

fn ensure(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(otherwise()) }
}

/// Runs `check` over the entries that `wanted` names, on every core; panics with all that is wrong.
fn each(wanted: fn(&Vector) -> bool, check: impl Fn(&Manifest, &Vector) -> Result<(), String> + Sync) {
    let manifest = Manifest::read().expect("the manifest");
    let entries: Vec<&Vector> = manifest.vectors.iter().filter(|vector| wanted(vector)).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let taken = std::iter::from_fn(|| entries.get(next.fetch_add(1, Ordering::Relaxed)));
        let failed = taken
            .filter_map(|entry| check(&manifest, entry).err().map(|wrong| format!("{}: {wrong}", entry.id)));
        failed.collect::<Vec<String>>()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let failed: Vec<String> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("no vector panics")).collect()
    });
    println!("{} vectors, {} wrong", entries.len(), failed.len());
    assert!(!entries.is_empty(), "no vector");
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Whether it is a codestream that decodes; streams have tests of their own.
fn decodes(vector: &Vector) -> bool {
    matches!(vector.expect, Expect::Crc32(_)) && !vector.file.starts_with("streams/")
}

fn is_rejected(vector: &Vector) -> bool {
    matches!(vector.expect, Expect::Error(_))
}

fn each_golden(check: impl Fn(&Golden<'_>) -> Result<(), String> + Sync) {
    each(decodes, |_, entry| check(&Golden::read(entry)?));
}

#[test]
fn files_and_entries_are_each_others() {
    let manifest = Manifest::read().expect("the manifest");
    let listed: BTreeSet<String> = manifest.vectors.iter().map(|vector| vector.file.clone()).collect();
    assert_eq!(listed.len(), manifest.vectors.len(), "a file in two entries");
    let mut present = BTreeSet::new();
    for inside in ["v2", "streams", "handmade", "reject"] {
        for file in std::fs::read_dir(folder().join(inside)).expect("a folder of vectors") {
            let name = file.expect("a file").file_name().into_string().expect("a plain name");
            present.insert(format!("{inside}/{name}"));
        }
    }
    let missing: Vec<_> = listed.difference(&present).collect();
    let unlisted: Vec<_> = present.difference(&listed).collect();
    assert!(
        missing.is_empty() && unlisted.is_empty(),
        "missing: {missing:?}; without an entry: {unlisted:?}"
    );
    println!("{} files, each with its entry", present.len());
}

#[test]
fn every_file_is_the_recorded_one() {
    each(
        |_| true,
        |_, entry| {
            let bytes = entry.read()?;
            ensure(entry.bytes == Some(bytes.len()), || format!("{} bytes", bytes.len()))?;
            ensure(entry.sha256 == Some(sha256(&bytes)), || "not the recorded checksum".to_owned())
        },
    );
}

#[test]
fn every_vector_decodes_to_its_samples_at_every_level() {
    each_golden(|golden| {
        let found = Expect::Crc32(crc32(&golden.levels[0]));
        ensure(found == golden.entry.expect, || format!("{found:?}"))?;
        for (level, expected) in golden.levels() {
            let decoded = decode(&golden.bytes, level, &golden.header);
            ensure(decoded.as_ref() == Ok(expected), || format!("level {level}"))?;
        }
        let max = golden.header.plan().levels();
        let beyond = decode(&golden.bytes, max + 1, &golden.header);
        ensure(beyond == Err(DecodeError::LevelOutOfRange { max }), || format!("{beyond:?}"))
    });
}

#[test]
fn every_vector_with_a_recipe_is_encoded_to_its_bytes() {
    each(
        |entry| decodes(entry) && entry.hex.is_none(),
        |manifest, entry| {
            let golden = Golden::read(entry)?;
            let (_, recipe) = entry.recipe()?;
            let samples = manifest.samples(entry)?;
            let (header, slack) = (&golden.header, u64::from(recipe.slack()));
            ensure(off(recipe.sample_type(), &samples, &golden.levels[0]) <= slack, || {
                "its input is another".to_owned()
            })?;
            ensure(header.plan().extent().axes() == recipe.extent(), || "its extent is another".to_owned())?;
            ensure(header.sample_type() == recipe.sample_type(), || "its type is another".to_owned())?;
            match recipe {
                Recipe::Coded(coded) => {
                    let same = header.plan().levels() == coded.levels
                        && header.is_dense() == (coded.effort == Effort::Dense)
                        && by_storage(&golden.bytes)
                            == [Effort::Tabled, Effort::Wide, Effort::Light]
                                .into_iter()
                                .find(|effort| *effort == coded.effort);
                    ensure(same && header.slack().is_none(), || {
                        "its levels or storage are others".to_owned()
                    })?;
                }
                Recipe::Rows(_) | Recipe::Slabs(_) => return Err("it is a stream".to_owned()),
                Recipe::Lattice(_) => {
                    ensure(header.slack() == Some(recipe.slack()), || "its slack is another".to_owned())?;
                }
            }
            ensure(recipe.encode(&samples)? == golden.bytes, || "the encoder makes other bytes".to_owned())
        },
    );
}

/// The effort that alone writes codestreams of this storage.
fn by_storage(bytes: &[u8]) -> Option<Effort> {
    match bytes[3] {
        3 => Some(Effort::Tabled),
        5 => Some(Effort::Light),
        6 => Some(Effort::Wide),
        _ => None,
    }
}

/// The largest distance of a sample from another at the same place.
fn off(sample_type: SampleType, samples: &[i32], others: &[i32]) -> u64 {
    let value = |sample: i32| match sample_type {
        SampleType::U32 => i64::from(sample.cast_unsigned()),
        _ => i64::from(sample),
    };
    assert_eq!(samples.len(), others.len(), "as many samples as the extent says");
    let distances = samples.iter().zip(others).map(|(&one, &other)| value(one).abs_diff(value(other)));
    distances.max().expect("an extent has samples")
}

/// Storage, and predictor of the low-pass part or of a subband of wavelet coefficients.
fn choices(bytes: &[u8]) -> BTreeSet<String> {
    let header = coder::Header::parse(bytes).expect("a codestream");
    let predictors = coder::predictors(bytes).expect("a codestream");
    let named = predictors.iter().zip(shapes(&header.choices)).map(|(predictor, shape)| {
        let of = if shape.is_low_pass { "low-pass" } else { "details" };
        match predictor {
            Predictor::Fixed(number) => format!("{of} {number}"),
            Predictor::Weights(_) => format!("{of} weights"),
            Predictor::Zero => format!("{of} zero"),
        }
    });
    named.chain([format!("{:?}", header.choices.storage)]).collect()
}

#[test]
fn every_choice_of_the_encoder_is_among_its_vectors() {
    let manifest = Manifest::read().expect("the manifest");
    let mut found = BTreeSet::new();
    for vector in manifest.vectors.iter().filter(|vector| vector.file.starts_with("v2/")) {
        let bytes = vector.read().expect("its file");
        let header = Header::parse(&bytes).expect("a codestream");
        if header.is_dense() || by_storage(&bytes).is_some() || header.slack().is_some() {
            continue;
        }
        let choices = choices(&bytes);
        let trained = choices.iter().any(|choice| choice.ends_with("weights"));
        assert_eq!(trained, vector.id.starts_with("trained_"), "{}: {choices:?}", vector.id);
        found.extend(choices);
    }
    let expected = [
        "Coded",
        "Stored",
        "details weights",
        "details zero",
        "low-pass 0",
        "low-pass 1",
        "low-pass 2",
        "low-pass 3",
        "low-pass 4",
        "low-pass weights",
    ];
    assert_eq!(found, expected.map(str::to_owned).into());
}

/// And yet each level whose segment is complete is there.
#[test]
fn every_prefix_is_truncated() {
    each_golden(|golden| {
        for len in 0..golden.bytes.len() {
            for (level, expected) in golden.levels() {
                let decoded = decode(&golden.bytes[..len], level, &golden.header);
                let complete = len >= golden.enough(level);
                let right = if complete {
                    decoded.as_ref() == Ok(expected)
                } else {
                    decoded == Err(DecodeError::Truncated)
                };
                ensure(right, || format!("level {level} of the first {len} bytes"))?;
            }
        }
        ensure(golden.enough(0) == golden.bytes.len(), || "the finest level ends early".to_owned())
    });
}

#[test]
fn every_flipped_bit_is_survived() {
    each_golden(|golden| {
        let mut bytes = golden.bytes.clone();
        // Of many samples, not to take minutes, every thirteenth.
        let step = if golden.levels[0].len() > 10_000 { 13 } else { 1 };
        for bit in (0..8 * bytes.len()).step_by(step) {
            bytes[bit / 8] ^= 1 << (bit % 8);
            let decoded = decode(&bytes, 0, &golden.header);
            bytes[bit / 8] ^= 1 << (bit % 8);
            let range = golden.header.sample_type().range();
            // A flip of the type may give any sample; all others keep the header's range.
            let fits = bit / 8 == 4 || decoded.iter().flatten().all(|sample| range.contains(sample));
            ensure(fits, || format!("bit {bit}: a sample outside its type"))?;
        }
        let decoded = decode(&bytes, 0, &golden.header);
        ensure(decoded.as_ref() == Ok(&golden.levels[0]), || "spoilt".to_owned())
    });
}

#[test]
fn a_byte_more_is_trailing() {
    each_golden(|golden| {
        for byte in [0, 1, 0x77, 0xFF] {
            let longer = [&golden.bytes[..], &[byte]].concat();
            for (level, _) in golden.levels() {
                let decoded = decode(&longer, level, &golden.header);
                ensure(decoded == Err(DecodeError::TrailingBytes), || format!("level {level}: {decoded:?}"))?;
            }
        }
        Ok(())
    });
}

#[test]
fn what_must_be_rejected_is_for_its_reason() {
    each(is_rejected, |_, entry| {
        let found = outcome(&entry.read()?);
        ensure(found == entry.expect, || format!("{found:?}"))?;
        ensure(entry.file.starts_with("reject/"), || format!("is in {}", entry.file))
    });
}
