//! Tabled codestreams, written and read the plain way, from `kernel/docs/tabled.md` and `kernel/docs/codestream.md`
//! alone: every neighbour is looked up anew, one token after the other.
//!
//! The encoder chooses nothing: the weights are given, and the frequencies too or counted.

mod bits;
mod model;
mod numerals;
mod rows;
mod token;

use super::coder::{Reject, SampleType, number_bytes};
pub use bits::{BitReader, BitWriter};
pub use model::{CLASSES, Model, sets};
use numerals::{Numerals, Symbol};
use rows::{Rows, class, prediction};
use token::{TOKENS, Token};

/// A segment of a span above 0, cut into its fields.
#[derive(Debug, Clone, PartialEq, Eq)]
#[expect(missing_docs, reason = "named as in the text")]
pub struct Segment {
    pub lowest: i32,
    pub span: i32,
    pub extra: Vec<u8>,
    /// Weights and tables.
    pub model: Vec<u8>,
    pub states: [u32; 4],
    pub words: Vec<u16>,
}

impl Segment {
    /// Its bytes.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = constant(self.lowest, self.span);
        bytes.extend((self.extra.len() as u32).to_le_bytes());
        bytes.extend(&self.extra);
        bytes.extend(&self.model);
        bytes.extend(self.states.iter().flat_map(|state| state.to_le_bytes()));
        bytes.extend(self.words.iter().flat_map(|word| word.to_le_bytes()));
        bytes
    }

    /// Cuts a segment of samples of that extent into its fields.
    ///
    /// # Errors
    ///
    /// [`Reject::Segment`].
    pub fn parse(bytes: &[u8], extent: [usize; 3]) -> Result<(Self, Model), Reject> {
        let mut fields = Fields(bytes);
        let [lowest, span, extra_length] = [fields.four()?, fields.four()?, fields.four()?];
        let extra = fields.take(extra_length as usize)?.to_vec();
        let mut bits = BitReader::new(fields.0);
        let model = Model::read(&mut bits, extent)?;
        let rest = bits.finish()?;
        let model_bytes = fields.0[..fields.0.len() - rest.len()].to_vec();
        fields.0 = rest;
        let states = [fields.four()?, fields.four()?, fields.four()?, fields.four()?];
        let (words, odd) = fields.0.as_chunks::<2>();
        if !odd.is_empty() {
            return Err(Reject::Segment);
        }
        let words = words.iter().map(|&word| u16::from_le_bytes(word)).collect();
        let segment =
            Self { lowest: lowest as i32, span: span as i32, extra, model: model_bytes, states, words };
        Ok((segment, model))
    }
}

/// The segment of samples that are all `lowest`, if the span is 0.
pub fn constant(lowest: i32, span: i32) -> Vec<u8> {
    [lowest.to_le_bytes(), span.to_le_bytes()].concat()
}

/// The codestream of one segment.
pub fn codestream(segment: &[u8], extent: [usize; 3], sample_type: SampleType) -> Vec<u8> {
    let sample_type = SampleType::ALL.iter().position(|&t| t == sample_type).expect("all are listed");
    let mut bytes = vec![0x77, 0x4C, 2, 3, sample_type as u8, 0];
    bytes.extend(extent.into_iter().chain([segment.len()]).flat_map(number_bytes));
    bytes.extend(segment);
    bytes
}

struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Reject> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Reject::Segment)?;
        self.0 = rest;
        Ok(taken)
    }

    fn four(&mut self) -> Result<u32, Reject> {
        self.take(4).map(|bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }
}

/// The samples of a tabled codestream of that extent and type, from its segment alone.
///
/// # Errors
///
/// [`Reject::Segment`] and [`Reject::Sample`].
pub fn decode(bytes: &[u8], extent: [usize; 3], sample_type: SampleType) -> Result<Vec<i32>, Reject> {
    let mut fields = Fields(bytes);
    let [lowest, span] = [fields.four()? as i32, fields.four()? as i32];
    let values = match span {
        0 if fields.0.is_empty() => vec![0; extent.iter().product()],
        1..0x8_0000 if extent[1] * extent[2] > 1 => decode_values(bytes, extent)?,
        _ => return Err(Reject::Segment),
    };
    let samples: Vec<i32> = values.into_iter().map(|v| lowest.wrapping_add(v as i32)).collect();
    if samples.iter().all(|&v| sample_type.holds(v)) { Ok(samples) } else { Err(Reject::Sample) }
}

/// The samples less the lowest.
fn decode_values(bytes: &[u8], extent: [usize; 3]) -> Result<Vec<i64>, Reject> {
    let (segment, model) = Segment::parse(bytes, extent)?;
    let ranks = decode_ranks(&segment, &model, extent)?;
    let mut samples = Rows::new(extent);
    for (place, rank) in rows::places(extent).zip(&ranks.values) {
        let p = prediction(&samples, &model, i64::from(segment.span), place);
        samples.values.push(p + token::value_of_rank(*rank));
    }
    Ok(samples.values)
}

fn decode_ranks(segment: &Segment, model: &Model, extent: [usize; 3]) -> Result<Rows, Reject> {
    let mut numerals = Numerals::new(segment.states, &segment.words)?;
    let mut extra = BitReader::new(&segment.extra);
    let mut ranks = Rows::new(extent);
    for place in rows::places(extent) {
        let table = &model.tables[class(&ranks, place)];
        let token = numerals.token(place[0] % 4, table)?;
        ranks.values.push(Token::read(token, &mut extra)?);
    }
    numerals.finish()?;
    if extra.finish()?.is_empty() { Ok(ranks) } else { Err(Reject::Segment) }
}

/// The smallest sample and the span.
pub fn bounds(samples: &[i32]) -> [i32; 2] {
    let lowest = samples.iter().min().expect("there are samples");
    let highest = samples.iter().max().expect("there are samples");
    [*lowest, highest - lowest]
}

/// Weights, and frequencies from the counts of the tokens that these samples have.
pub fn fit(samples: &[i32], extent: [usize; 3], bounds: [i32; 2], weights: Vec<Vec<i64>>) -> Model {
    let mut model = Model { weights, tables: vec![Vec::new(); CLASSES] };
    let ranks = ranks(samples, extent, bounds, &model);
    let mut counts = vec![vec![0; TOKENS]; CLASSES];
    for (place, &rank) in rows::places(extent).zip(&ranks.values) {
        counts[class(&ranks, place)][Token::of(rank).number] += 1;
    }
    model.tables = counts.iter().map(|counts| model::frequencies(counts)).collect();
    model
}

/// The segment of samples under a smallest sample, a span and a model, whether they are right or not. Panics if a token
/// has no frequency in its class.
pub fn encode(samples: &[i32], extent: [usize; 3], bounds: [i32; 2], model: &Model) -> Segment {
    let ranks = ranks(samples, extent, bounds, model);
    let (mut extra, mut symbols) = (BitWriter::default(), Vec::new());
    for (place, &rank) in rows::places(extent).zip(&ranks.values) {
        let token = Token::of(rank);
        extra.bits(token.extra_bits, token.extra);
        symbols.push(Symbol::new(place[0] % 4, &model.tables[class(&ranks, place)], token.number));
    }
    let (states, words) = numerals::encode(&symbols);
    let [lowest, span] = bounds;
    Segment { lowest, span, extra: extra.bytes, model: model.write().bytes, states, words }
}

fn ranks(samples: &[i32], extent: [usize; 3], [lowest, span]: [i32; 2], model: &Model) -> Rows {
    let values = samples.iter().map(|v| i64::from(v.wrapping_sub(lowest))).collect();
    let samples = Rows { extent, values };
    let residual = |(place, v): ([usize; 3], &i64)| v - prediction(&samples, model, i64::from(span), place);
    let residuals = rows::places(extent).zip(&samples.values).map(residual);
    Rows { extent, values: residuals.map(token::rank_of_value).collect() }
}
