//! Finding out, on parts of a volume, what makes it smallest.

use wavelift_kernel::SampleType;

use super::brick::{Coding, Encoded, Samples, Unencodable, Worker};
use super::choice::{Candidates, Transform};
use super::grid::per_axis;
use super::survey::Survey;
use super::{Brick, CompressError, Effort, Form, Grid, Pool, scaled, steps};
use crate::volume::ElementType;

/// The part of a volume that something is tried on.
#[derive(Clone, Copy, Debug)]
struct Share {
    /// One in so many samples,
    one_in: u64,
    /// but at least so many, if there are,
    fewest: u64,
    /// in about so many pieces, or more where bricks have less,
    pieces: u64,
    /// but at most in so many.
    most_pieces: u64,
}

/// The part that each form is tried on.
const OF_FORMS: Share = Share { one_in: 16, fewest: 1 << 15, pieces: 2, most_pieces: 8 };

/// As [`OF_FORMS`], where there are lattices: a lattice learns long, and would seem worse in small pieces.
const OF_LATTICES: Share = Share { one_in: 4, fewest: 1 << 18, pieces: 1, most_pieces: 4 };

/// As [`OF_FORMS`], for each wavelet.
const OF_WAVELETS: Share = Share { one_in: 32, ..OF_FORMS };

/// Samples that a piece has, if there are so many: the kernel codes fewer in another way.
const FEWEST: u64 = 1 << 14;

/// Bytes that a packed value takes in the index, about.
const BYTES_PER_VALUE: u64 = 2;

/// Boxes of a volume, as little-endian samples.
pub(super) type Cut<'a> = &'a mut (dyn FnMut(&[Brick]) -> Result<Vec<Vec<u8>>, CompressError> + Send);

/// A volume, to be tried.
pub(super) struct Trial<'a> {
    pub(super) pool: &'a Pool,
    pub(super) survey: &'a Survey,
    pub(super) element: ElementType,
    pub(super) grid: &'a Grid,
    pub(super) effort: Effort,
    /// How far a sample may move.
    pub(super) error: f64,
}

/// A part of the volume.
struct Piece {
    sides: [u32; 3],
    bytes: Vec<u8>,
}

/// The only piece, which is the whole volume, encoded as its only brick is.
#[derive(Debug)]
pub(super) struct Tried {
    sides: [u32; 3],
    bytes: Vec<u8>,
    encoded: Encoded,
}

impl Tried {
    /// Bytes of memory that it takes, about.
    pub(super) fn held(&self) -> u64 {
        (self.bytes.len() + self.encoded.bytes.len()) as u64
    }

    /// What a brick is encoded to, if it is that one.
    pub(super) fn encoded(&self, samples: Samples<'_>) -> Option<Encoded> {
        (samples.sides == self.sides && samples.bytes == self.bytes).then(|| self.encoded.clone())
    }
}

/// What a coding makes of pieces.
struct Cost {
    bytes: u64,
    /// Of the only piece, where it was encoded no other way than bricks are.
    encoded: Option<Encoded>,
}

impl Trial<'_> {
    /// What makes a few pieces, spread over the volume, smallest: first of the forms that the samples have, then of
    /// the transforms. `default` and `dense` are tried as the effort below, unless samples may move, as a lattice is
    /// their rival, or there is a transform.
    ///
    /// Codes a 16th of the volume per form, a quarter where there are lattices, and a 32nd per wavelet, but of small
    /// volumes more. Where the only piece is the whole volume it need not be coded again.
    pub(super) fn best(
        &self,
        candidates: &Candidates,
        cut: Cut<'_>,
    ) -> Result<(Coding, Option<Tried>), CompressError> {
        let transforms: Vec<Transform> = candidates.transforms().collect();
        let first = transforms.first().copied().unwrap_or(Transform::NONE);
        let forms: Vec<Coding> = self.forms(first).into_iter().map(|form| self.coding(first, form)).collect();
        let has_lattices = forms.iter().any(|coding| coding.form.slack().is_some());
        let share = if has_lattices { OF_LATTICES } else { OF_FORMS };
        // With one form there is nothing to be tried.
        let pieces = if forms.len() > 1 { self.pieces(share, cut)? } else { Vec::new() };
        let (best, tried) = self.smallest(forms, pieces)?;
        if transforms.len() <= 1 {
            return Ok((best, tried));
        }
        let pieces = self.pieces(OF_WAVELETS, cut)?;
        let codings = transforms.into_iter().map(|transform| self.coding(transform, best.form.clone()));
        Ok(self.smallest(codings.collect(), pieces)?)
    }

    /// The forms that the samples may be written in. Floats that may move and are narrow then need not be tried exactly:
    /// bricks of which that is shorter are found one by one.
    fn forms(&self, transform: Transform) -> Vec<Form> {
        let is_integer = !self.element.is_float();
        let stepped = steps::width(self.error).filter(|_| is_integer).map(Form::Steps);
        let scaled = self.scaled(0);
        let is_narrow =
            matches!(scaled, Some(Form::Scaled { integers: SampleType::I8 | SampleType::I16, .. }));
        let exact = (self.error == 0.0 || !is_narrow).then(|| stepped.unwrap_or(Form::Exact));
        let mut forms: Vec<Form> = exact.into_iter().chain(scaled).collect();
        if transform.wavelet.is_none() {
            forms.extend(self.lattice());
            forms.extend(self.survey.values().map(Form::Packed));
        }
        forms
    }

    /// The form of floats on a scale, if there is one.
    fn scaled(&self, most_slack: u32) -> Option<Form> {
        scaled::form(self.survey.profile()?, self.error, most_slack)
    }

    /// The form of a lattice, if one may move samples.
    fn lattice(&self) -> Option<Form> {
        let element = self.element;
        let form = match steps::slack(self.error) {
            _ if self.error == 0.0 || !self.effort.has_lattices() => None,
            _ if element.is_float() => self.scaled(u32::MAX),
            slack => slack.map(Form::Near),
        };
        form.filter(|form| form.slack().is_some() && form.suits(element))
    }

    fn coding(&self, transform: Transform, form: Form) -> Coding {
        Coding { effort: self.effort, transform, form, error: self.error }
    }

    /// The coding that makes `pieces` smallest, the first of several, and what it makes of the only one.
    fn smallest(
        &self,
        mut codings: Vec<Coding>,
        mut pieces: Vec<Piece>,
    ) -> Result<(Coding, Option<Tried>), Unencodable> {
        if codings.len() <= 1 {
            return Ok((codings.swap_remove(0), None));
        }
        let cost = |coding| self.pool.with_worker(|worker| self.cost(worker, coding, &pieces));
        let costs = self.pool.try_map(codings.iter().collect(), cost)?;
        let (best, cost) =
            costs.into_iter().enumerate().min_by_key(|(_, cost)| cost.bytes).expect("there are some");
        let tried = cost.encoded.zip(pieces.pop());
        let tried = tried.map(|(encoded, Piece { sides, bytes })| Tried { sides, bytes, encoded });
        Ok((codings.swap_remove(best), tried))
    }

    /// Bytes of `pieces`, and the share that they have in what the index will say of values.
    fn cost(&self, worker: &mut Worker, coding: &Coding, pieces: &[Piece]) -> Result<Cost, Unencodable> {
        let effort = match (coding.effort, coding.transform.wavelet) {
            (effort, _) if self.error > 0.0 => effort,
            (Effort::Dense, _) | (Effort::Default, Some(_)) => Effort::Default,
            (Effort::Default | Effort::Fast, _) => Effort::Fast,
            (Effort::Light, _) => Effort::Light,
        };
        let cheaper = Coding { effort, ..coding.clone() };
        let encode = |Piece { sides, bytes }: &Piece| {
            worker.encode(Samples { element: self.element, sides: *sides, bytes }, &cheaper)
        };
        let mut encoded = pieces.iter().map(encode).collect::<Result<Vec<Encoded>, _>>()?;
        let bytes: u64 = encoded.iter().map(|encoded| encoded.bytes.len() as u64).sum();
        let tried: u64 = pieces.iter().map(|piece| (piece.bytes.len() / self.element.bytes()) as u64).sum();
        let values = coding.form.values().map_or(0, |values| BYTES_PER_VALUE * values.count() as u64);
        let of_index = (u128::from(values) * u128::from(tried) / u128::from(self.samples())) as u64;
        let is_whole = effort == coding.effort && tried == self.samples();
        Ok(Cost { bytes: bytes + of_index, encoded: encoded.pop().filter(|_| is_whole && pieces.len() == 1) })
    }

    /// Some boxes as of small bricks, spread over the volume: together a `share` of it.
    fn pieces(&self, share: Share, cut: Cut<'_>) -> Result<Vec<Piece>, CompressError> {
        let boxes = self.boxes(share);
        let cut = cut(&boxes)?;
        Ok(boxes.into_iter().zip(cut).map(|(piece, bytes)| Piece { sides: piece.sides, bytes }).collect())
    }

    fn boxes(&self, share: Share) -> Vec<Brick> {
        let samples = (self.samples() / share.one_in).max(share.fewest);
        let mut sides = self.grid.sides;
        let whole: u64 = sides.into_iter().map(u64::from).product();
        let most = (samples / whole.min(share.fewest / share.pieces)).clamp(1, share.most_pieces);
        let size = |sides: [u32; 3]| sides.into_iter().map(u64::from).product::<u64>();
        while size(sides) > samples / most {
            let longest = (0..3).max_by_key(|&axis| sides[axis]).unwrap_or(0);
            let halved = per_axis(|axis| sides[axis].div_ceil(if axis == longest { 2 } else { 1 }));
            if size(halved) < FEWEST {
                break;
            }
            sides = halved;
        }
        let count = (samples / size(sides)).clamp(1, most);
        // Each place along an axis once, in another order along each: the steps have no factor in common with any count.
        let origin = |number: u64, axis: usize| {
            let place = (2 * number + 1) * [1, 11, 13][axis] % (2 * count);
            let room = u128::from(self.grid.extent[axis] - u64::from(sides[axis]));
            (room * u128::from(place) / u128::from(2 * count)) as u64
        };
        (0..count).map(|number| Brick { origin: per_axis(|axis| origin(number, axis)), sides }).collect()
    }

    fn samples(&self) -> u64 {
        self.grid.extent.into_iter().product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_same_samples_need_not_be_coded_again() {
        let encoded = Encoded { bytes: vec![7], ..Encoded::default() };
        let tried = Tried { sides: [2, 1, 1], bytes: vec![1, 2], encoded };
        let of = |sides, bytes| {
            let samples = Samples { element: ElementType::U8, sides, bytes };
            tried.encoded(samples).map(|encoded| encoded.bytes)
        };
        assert_eq!(of([2, 1, 1], &[1, 2]), Some(vec![7]));
        assert_eq!(of([2, 1, 1], &[1, 3]), None);
        assert_eq!(of([1, 2, 1], &[1, 2]), None);
    }
}
