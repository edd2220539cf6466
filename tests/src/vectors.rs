//! Golden vectors: the entries of `vectors/MANIFEST.toml`, and what is made of them.
//!
//! A vector with a recipe (`input` and `plan`) is what the encoder makes of that input; any other is the bytes of
//! its `hex`. Messages are for people: every error is a sentence that names the vector or file.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use wavelift_kernel::stream::{RowPlan, SlabPlan};
use wavelift_kernel::{
    Codec, DecodeError, Extent, Header, LengthError, Near, Plan, SampleType, Slice, Wavelet,
};

use crate::effort::Effort;
use crate::inputs::{Input, positions};
use crate::lent;
use crate::slabs;
use crate::streams::{self, Pieces};

/// Samples that a vector may claim to hold; a larger claim is refused before memory is taken for it.
const MAX_SAMPLES: usize = 1 << 20;

/// `vectors/MANIFEST.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of the codestream that the encoder writes today.
    pub codestream: u8,
    /// Data files: samples without any header.
    pub data: Vec<Data>,
    /// Golden codestreams.
    #[serde(rename = "vector")]
    pub vectors: Vec<Vector>,
}

/// A built-in data file of unsigned bytes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Data {
    /// Name that recipes use.
    pub id: String,
    /// From the folder of the manifest.
    pub file: String,
    /// Checksum of the file.
    pub sha256: String,
    /// Samples per axis.
    pub extent: [u32; 3],
    /// Type of the samples.
    #[serde(rename = "type", deserialize_with = "sample_type")]
    pub sample_type: SampleType,
    /// Where the data come from.
    pub origin: String,
    /// SPDX identifier.
    pub licence: String,
}

/// A golden codestream.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vector {
    /// Unique name; the name of the file without its ending.
    pub id: String,
    /// From the folder of the manifest, in `v2/`, `streams/`, `handmade/` or `reject/`.
    pub file: String,
    /// Checksum of the file; absent until the file is added.
    pub sha256: Option<String>,
    /// Length of the file; absent until the file is added.
    pub bytes: Option<usize>,
    /// `encoder` and its version, `oracle`, or `handmade`.
    pub origin: String,
    /// Where the samples come from.
    pub input: Option<Input>,
    /// How they are encoded.
    pub plan: Option<Recipe>,
    /// The bytes of a vector without a recipe; blanks between them are for the reader.
    pub hex: Option<String>,
    /// Version of the codestream it is written in.
    pub since: u8,
    /// Why it exists.
    pub shows: String,
    /// What a decoder makes of it.
    pub expect: Expect,
    /// Why the file was replaced, the last time it was.
    pub replaced: Option<String>,
}

/// How the samples of a vector are encoded.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
pub enum Recipe {
    /// By the codec.
    Coded(Coded),
    /// As a lattice.
    Lattice(Nearness),
    /// Row by row.
    Rows(Rows),
    /// Slice by slice, in slabs.
    Slabs(Slabs),
}

/// Effort, wavelet, extent, levels and type of a recipe.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coded {
    /// How much the encoder tries.
    pub effort: Effort,
    /// By its name.
    #[serde(deserialize_with = "wavelet")]
    pub wavelet: Wavelet,
    /// Samples per axis.
    pub extent: [u32; 3],
    /// Levels of the transform.
    pub levels: u8,
    /// Type of the samples.
    #[serde(rename = "type", deserialize_with = "sample_type")]
    pub sample_type: SampleType,
}

/// Slack, extent and type of a recipe.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Nearness {
    /// How far a decoded sample may be from its original.
    pub slack: u32,
    /// Samples per axis.
    pub extent: [u32; 3],
    /// Type of the samples.
    #[serde(rename = "type", deserialize_with = "sample_type")]
    pub sample_type: SampleType,
}

/// A recipe of a stream of rows.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rows {
    /// Rows of a strip.
    pub strip: u16,
    /// By its name.
    #[serde(deserialize_with = "wavelet")]
    pub wavelet: Wavelet,
    /// Samples per axis.
    pub extent: [u32; 3],
    /// Levels of the transform.
    pub levels: u8,
    /// Type of the samples.
    #[serde(rename = "type", deserialize_with = "sample_type")]
    pub sample_type: SampleType,
}

/// A recipe of a stream of slabs.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slabs {
    /// How much the encoder tries.
    pub effort: Effort,
    /// Slices of a slab.
    pub slab: u32,
    /// By its name.
    #[serde(deserialize_with = "wavelet")]
    pub wavelet: Wavelet,
    /// Samples per axis.
    pub extent: [u32; 3],
    /// Levels of the transform.
    pub levels: u8,
    /// Type of the samples.
    #[serde(rename = "type", deserialize_with = "sample_type")]
    pub sample_type: SampleType,
}

impl Rows {
    fn encode(&self, samples: &[i32]) -> Result<Vec<u8>, String> {
        let plan = RowPlan::new(self.wavelet, self.extent[0], self.levels, self.sample_type);
        let plan = plan.map_err(|error| error.to_string())?.with_strip(self.strip);
        Ok(streams::encode(&plan, samples, Pieces::Whole))
    }
}

impl Slabs {
    fn encode(&self, samples: &[i32]) -> Result<Vec<u8>, String> {
        let [x, y, _] = self.extent;
        let extent = Extent::brick(x, y, self.slab).map_err(|error| error.to_string())?;
        let plan = SlabPlan::new(self.wavelet, extent, self.levels, self.sample_type);
        Ok(slabs::encode(&plan.map_err(|error| error.to_string())?, self.effort, samples, 1 << 12))
    }
}

impl Recipe {
    /// Samples per axis.
    #[must_use]
    pub const fn extent(&self) -> [u32; 3] {
        match self {
            Self::Coded(coded) => coded.extent,
            Self::Lattice(lattice) => lattice.extent,
            Self::Rows(rows) => rows.extent,
            Self::Slabs(slabs) => slabs.extent,
        }
    }

    /// Type of the samples.
    #[must_use]
    pub const fn sample_type(&self) -> SampleType {
        match self {
            Self::Coded(coded) => coded.sample_type,
            Self::Lattice(lattice) => lattice.sample_type,
            Self::Rows(rows) => rows.sample_type,
            Self::Slabs(slabs) => slabs.sample_type,
        }
    }

    /// How far a decoded sample may be from its original.
    #[must_use]
    pub const fn slack(&self) -> u32 {
        match self {
            Self::Coded(_) | Self::Rows(_) | Self::Slabs(_) => 0,
            Self::Lattice(lattice) => lattice.slack,
        }
    }

    /// The codestream of samples.
    ///
    /// # Errors
    ///
    /// If there is no such extent or plan, or a sample is outside its type.
    pub fn encode(&self, samples: &[i32]) -> Result<Vec<u8>, String> {
        let sample_type = self.sample_type();
        let extent = Extent::new(self.extent()).map_err(|error| error.to_string())?;
        if samples.iter().any(|sample| !sample_type.range().contains(sample)) {
            return Err("a sample is outside its type".to_owned());
        }
        match self {
            Self::Coded(coded) => {
                let plan =
                    Plan::new(coded.wavelet, extent, coded.levels).map_err(|error| error.to_string())?;
                Ok(lent::encode(&mut { Codec::NEW }, coded.effort, &plan, sample_type, samples))
            }
            Self::Lattice(Nearness { slack, .. }) => {
                Ok(lent::encode_near(Near { extent, sample_type, slack: *slack }, samples))
            }
            Self::Rows(rows) => rows.encode(samples),
            Self::Slabs(slabs) => slabs.encode(samples),
        }
    }
}

/// What decoding gives.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Expect {
    /// CRC-32 of the samples as little-endian `i32`, in hexadecimal.
    Crc32(String),
    /// The error as `Debug` prints it, such as `Malformed(Levels)`.
    Error(String),
}

fn wavelet<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Wavelet, D::Error> {
    let name = String::deserialize(deserializer)?;
    let found = Wavelet::ALL.into_iter().find(|wavelet| wavelet.name() == name);
    found.ok_or_else(|| serde::de::Error::custom(format!("no wavelet is called {name}")))
}

fn sample_type<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<SampleType, D::Error> {
    let name = String::deserialize(deserializer)?;
    let found = SampleType::ALL.into_iter().find(|candidate| format!("{candidate:?}").to_lowercase() == name);
    found.ok_or_else(|| serde::de::Error::custom(format!("no sample type is called {name}")))
}

/// The folder of the manifest.
#[must_use]
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors")
}

impl Manifest {
    /// Reads the manifest of the repository.
    ///
    /// # Errors
    ///
    /// If it cannot be read, or is not a manifest.
    pub fn read() -> Result<Self, String> {
        let path = folder().join("MANIFEST.toml");
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        toml::from_str(&text).map_err(|error| format!("vectors/MANIFEST.toml: {error}"))
    }

    /// The vector of that name.
    ///
    /// # Errors
    ///
    /// If there is none.
    pub fn vector(&self, id: &str) -> Result<&Vector, String> {
        let found = self.vectors.iter().find(|vector| vector.id == id);
        found.ok_or_else(|| format!("vectors/MANIFEST.toml has no vector {id}"))
    }

    /// The samples of a vector with a recipe, x fastest.
    ///
    /// # Errors
    ///
    /// If the vector has no recipe, or a crop does not lie in its data file.
    pub fn samples(&self, vector: &Vector) -> Result<Vec<i32>, String> {
        let (input, recipe) = vector.recipe()?;
        let extent = Extent::new(recipe.extent()).map_err(|error| format!("{}: {error}", vector.id))?;
        match input {
            Input::File { data, corner } => self.crop(data, *corner, extent),
            generator => generator.generate(extent).ok_or_else(|| format!("{}: no generator", vector.id)),
        }
    }

    /// All samples of a data file, x fastest.
    ///
    /// # Errors
    ///
    /// If there is no such data file, or its length is not that of its extent.
    pub fn data_samples(&self, id: &str) -> Result<(Extent, Vec<i32>), String> {
        let data = self.data.iter().find(|data| data.id == id).ok_or_else(|| format!("no data file {id}"))?;
        let extent = Extent::new(data.extent).map_err(|error| format!("{id}: {error}"))?;
        let bytes = read(&data.file)?;
        if data.sample_type != SampleType::U8 || bytes.len() != extent.samples() {
            return Err(format!("{}: not one unsigned byte for each sample of its extent", data.file));
        }
        Ok((extent, bytes.into_iter().map(i32::from).collect()))
    }

    fn crop(&self, data: &str, corner: [u32; 3], extent: Extent) -> Result<Vec<i32>, String> {
        let (whole, samples) = self.data_samples(data)?;
        let [nx, ny, _] = whole.axes();
        let inside = (0..3).all(|axis| corner[axis] + extent.axes()[axis] <= whole.axes()[axis]);
        if !inside {
            return Err(format!("the crop of {data} at {corner:?} does not lie inside it"));
        }
        let index = |[x, y, z]: [u32; 3]| {
            let [x, y, z] = [corner[0] + x, corner[1] + y, corner[2] + z];
            ((z * ny + y) * nx + x) as usize
        };
        Ok(positions(extent).map(|position| samples[index(position)]).collect())
    }

    /// The bytes that the vector should have: of its recipe, or its hexadecimal digits.
    ///
    /// # Errors
    ///
    /// If the recipe cannot be encoded, or the digits are none.
    pub fn build(&self, vector: &Vector) -> Result<Vec<u8>, String> {
        if let Some(hex) = &vector.hex {
            return parse_hex(hex).ok_or_else(|| format!("{}: hex is not pairs of digits", vector.id));
        }
        let (_, recipe) = vector.recipe()?;
        recipe.encode(&self.samples(vector)?).map_err(|error| format!("{}: {error}", vector.id))
    }
}

impl Vector {
    /// Input and plan.
    ///
    /// # Errors
    ///
    /// If the vector has none, because it is handmade.
    pub fn recipe(&self) -> Result<(&Input, Recipe), String> {
        let input = self.input.as_ref().zip(self.plan);
        input.ok_or_else(|| format!("{}: has no recipe (input and plan)", self.id))
    }

    /// The bytes of its file.
    ///
    /// # Errors
    ///
    /// If the file cannot be read.
    pub fn read(&self) -> Result<Vec<u8>, String> {
        read(&self.file)
    }
}

/// What a decoder makes of some bytes, as a manifest would put it.
#[must_use]
pub fn outcome(bytes: &[u8]) -> Expect {
    match decode(bytes) {
        Ok(samples) => Expect::Crc32(crc32(&samples)),
        Err(error) => Expect::Error(format!("{error:?}")),
    }
}

/// Decodes at full resolution into memory taken for it. A claim of more samples than any vector has is refused
/// before, as memory that is too short.
///
/// # Errors
///
/// Those of [`lent::decode_any`].
pub fn decode(bytes: &[u8]) -> Result<Vec<i32>, DecodeError> {
    if bytes.starts_with(b"wS") {
        return decode_stream(bytes);
    }
    let header = Header::parse(bytes)?;
    let expected = header.samples_len(0);
    if expected > MAX_SAMPLES {
        return Err(DecodeError::Length(LengthError { slice: Slice::Samples, expected, actual: 0 }));
    }
    lent::decode_any(bytes, 0, &header)
}

/// Decodes a stream of rows or slabs, after which nothing may follow.
fn decode_stream(bytes: &[u8]) -> Result<Vec<i32>, DecodeError> {
    let (samples, end) = match RowPlan::parse(bytes) {
        Err(DecodeError::OtherCodec) => slabs::decode(bytes, 1 << 12),
        Ok((plan, _)) if plan.decoder_memory_len() > MAX_SAMPLES => {
            let expected = plan.decoder_memory_len();
            return Err(DecodeError::Length(LengthError { slice: Slice::Scratch, expected, actual: 0 }));
        }
        _ => streams::decode(bytes, MAX_SAMPLES, Pieces::Whole),
    };
    match end? {
        0 => Ok(samples),
        _ => Err(DecodeError::TrailingBytes),
    }
}

/// CRC-32 (of zlib and PNG) of samples as little-endian `i32`, as eight hexadecimal digits.
#[must_use]
pub fn crc32(samples: &[i32]) -> String {
    let mut hasher = crc32fast::Hasher::new();
    samples.iter().for_each(|sample| hasher.update(&sample.to_le_bytes()));
    format!("{:08x}", hasher.finalize())
}

/// SHA-256 of bytes in hexadecimal.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    hmac_sha256::Hash::hash(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn read(file: &str) -> Result<Vec<u8>, String> {
    std::fs::read(folder().join(file)).map_err(|error| format!("vectors/{file}: {error}"))
}

fn parse_hex(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<char> = text.chars().filter(|letter| !letter.is_whitespace()).collect();
    let (pairs, rest) = digits.as_chunks::<2>();
    let byte = |[high, low]: &[char; 2]| u8::try_from(high.to_digit(16)? * 16 + low.to_digit(16)?).ok();
    if rest.is_empty() { pairs.iter().map(byte).collect() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRY: &str = r#"
        codestream = 2
        data = []

        [[vector]]
        id = "a"
        file = "v2/a.wlc"
        origin = "encoder 0.1.0"
        input = { generator = "ramp", start = 0, step = [1, 2, 3] }
        plan = { effort = "fast", wavelet = "haar", extent = [2, 2, 1], levels = 1, type = "u8" }
        since = 2
        shows = "an example"
        expect = { crc32 = "00000000" }
    "#;

    #[test]
    fn an_entry_is_read_and_its_samples_are_made() {
        let manifest: Manifest = toml::from_str(ENTRY).unwrap();
        let vector = manifest.vector("a").unwrap();
        assert_eq!(manifest.samples(vector), Ok(vec![0, 1, 2, 3]));
        let Recipe::Coded(coded) = vector.recipe().unwrap().1 else { panic!("not a lattice") };
        assert_eq!((coded.effort, coded.wavelet), (Effort::Fast, Wavelet::Haar));
        assert_eq!(vector.expect, Expect::Crc32("00000000".to_owned()));
        assert!(manifest.vector("b").is_err());
    }

    #[test]
    fn a_misspelt_entry_is_refused() {
        for (from, to) in
            [("haar", "hear"), ("\"u8\"", "\"u9\""), ("fast", "fats"), ("shows", "show"), ("start", "begin")]
        {
            assert!(toml::from_str::<Manifest>(&ENTRY.replace(from, to)).is_err(), "{to}");
        }
    }

    #[test]
    fn hexadecimal_digits_come_in_pairs() {
        assert_eq!(parse_hex("00 fF\n7a"), Some(vec![0x00, 0xFF, 0x7A]));
        assert_eq!(parse_hex("0"), None);
        assert_eq!(parse_hex("0g"), None);
    }

    #[test]
    fn checksums_are_the_standard_ones() {
        let samples = [i32::from_le_bytes(*b"1234"), i32::from_le_bytes(*b"5678")];
        assert_eq!(crc32(&samples), "9ae0daaf");
        assert_eq!(sha256(b""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    }
}
