//! Tabled codestreams, written and read the plain way, from `kernel/docs/tabled.md` and `kernel/docs/codestream.md`
//! alone: every neighbour is looked up anew, one token after the other.
//!
//! The encoder chooses nothing: scale, weights and labels are given, and the frequencies too or counted.

mod bits;
mod form;
mod model;
mod numerals;
mod rows;
mod token;

use super::coder::{Reject, SampleType, number_bytes};
pub use bits::{BitReader, BitWriter};
pub use form::{Breadth, Form};
pub use model::{CLASSES, Model};
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

    /// Cuts a segment of samples of that form into its fields.
    ///
    /// # Errors
    ///
    /// [`Reject::Segment`].
    pub fn parse(bytes: &[u8], form: Form) -> Result<(Self, Model), Reject> {
        let mut fields = Fields(bytes);
        let [lowest, span, extra_length] = [fields.four()?, fields.four()?, fields.four()?];
        let extra = fields.take(extra_length as usize)?.to_vec();
        let mut bits = BitReader::new(fields.0);
        let model = Model::read(&mut bits, form)?;
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
pub fn codestream(segment: &[u8], form: Form, sample_type: SampleType) -> Vec<u8> {
    let sample_type = SampleType::ALL.iter().position(|&t| t == sample_type).expect("all are listed");
    let mut bytes = vec![0x77, 0x4C, 2, form.breadth.storage(), sample_type as u8, 0];
    bytes.extend(form.extent.into_iter().chain([segment.len()]).flat_map(number_bytes));
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

/// The samples of a tabled codestream of that form and type, from its segment alone.
///
/// # Errors
///
/// [`Reject::Segment`] and [`Reject::Sample`].
pub fn decode(bytes: &[u8], form: Form, sample_type: SampleType) -> Result<Vec<i32>, Reject> {
    let mut fields = Fields(bytes);
    let [lowest, span] = [fields.four()? as i32, fields.four()? as i32];
    let [width, height, depth] = form.extent;
    let values = match span {
        0 if fields.0.is_empty() => vec![0; width * height * depth],
        1.. if span < form.breadth.span_limit() && height * depth > 1 => {
            decode_values(bytes, form)?.values().to_vec()
        }
        _ => return Err(Reject::Segment),
    };
    let samples: Vec<i32> = values.into_iter().map(|v| lowest.wrapping_add(v)).collect();
    if samples.iter().all(|&v| sample_type.holds(v)) { Ok(samples) } else { Err(Reject::Sample) }
}

/// The samples less the lowest.
fn decode_values(bytes: &[u8], form: Form) -> Result<Rows, Reject> {
    let (segment, model) = Segment::parse(bytes, form)?;
    let ranks = decode_ranks(&segment, &model, form)?;
    let mut samples = Rows::new(form.extent, Vec::new());
    for (place, &rank) in rows::places(form.extent).zip(ranks.values()) {
        let p = prediction(&samples, (form, &model), segment.span, place);
        samples.push(p + token::value_of_rank(rank.into()));
    }
    Ok(samples)
}

fn decode_ranks(segment: &Segment, model: &Model, form: Form) -> Result<Rows, Reject> {
    let mut numerals = Numerals::new(segment.states, &segment.words)?;
    let mut extra = BitReader::new(&segment.extra);
    let mut ranks = Rows::new(form.extent, Vec::new());
    let tables = model.effective_tables();
    for place in rows::places(form.extent) {
        let table = &tables[class(&ranks, (form, model), place)];
        let token = numerals.token(place[0] % 4, table)?;
        ranks.push(Token::read(token, &mut extra)?);
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

/// The model with frequencies from the counts of the tokens that these samples have.
pub fn fit(samples: &[i32], form: Form, bounds: [i32; 2], mut model: Model) -> Model {
    let ranks = ranks(samples, form, bounds, &model);
    let mut counts = vec![vec![0; TOKENS]; CLASSES];
    for (place, &rank) in rows::places(form.extent).zip(ranks.values()) {
        counts[class(&ranks, (form, &model), place)][Token::of(rank.into()).number] += 1;
    }
    model.tables = counts.iter().map(|counts| model::frequencies(counts, form.breadth)).collect();
    model
}

/// The segment of samples under a smallest sample, a span and a model, whether they are right or not. Panics if a token
/// has no frequency in its class.
pub fn encode(samples: &[i32], form: Form, bounds: [i32; 2], model: &Model) -> Segment {
    let ranks = ranks(samples, form, bounds, model);
    let tables = model.effective_tables();
    let (mut extra, mut symbols) = (BitWriter::default(), Vec::new());
    for (place, &rank) in rows::places(form.extent).zip(ranks.values()) {
        let token = Token::of(rank.into());
        extra.bits(token.extra_bits, token.extra);
        let table = &tables[class(&ranks, (form, model), place)];
        symbols.push(Symbol::new(place[0] % 4, table, token.number));
    }
    let (states, words) = numerals::encode(&symbols);
    let [lowest, span] = bounds;
    Segment { lowest, span, extra: extra.bytes, model: model.write(form).bytes, states, words }
}

fn ranks(samples: &[i32], form: Form, [lowest, span]: [i32; 2], model: &Model) -> Rows {
    let samples = Rows::new(form.extent, samples.iter().map(|v| v.wrapping_sub(lowest)).collect());
    let mut ranks = Rows::new(form.extent, Vec::new());
    for (place, &v) in rows::places(form.extent).zip(samples.values()) {
        let p = prediction(&samples, (form, model), span, place);
        ranks.push(token::rank_of_value(i64::from(v) - p));
    }
    ranks
}
