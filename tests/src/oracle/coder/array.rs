//! Samples and coefficients by their places, and a level as its subbands.

/// A place, counted from the origin of an array; it may lie beyond the borders.
pub(in crate::oracle) type Place = [isize; 3];

/// Values of an extent, x fastest.
#[derive(Debug, Clone)]
pub(in crate::oracle) struct Array {
    pub(in crate::oracle) extent: [usize; 3],
    pub(in crate::oracle) values: Vec<i32>,
}

impl Array {
    pub(in crate::oracle) fn zeros(extent: [usize; 3]) -> Self {
        Self { extent, values: vec![0; extent.iter().product()] }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.extent.contains(&0)
    }

    /// All places, x fastest, then y, then z.
    pub(super) fn places(&self) -> Vec<Place> {
        let [width, height, depth] = self.extent.map(usize::cast_signed);
        let rows = (0..depth).flat_map(|z| (0..height).map(move |y| (y, z)));
        rows.flat_map(|(y, z)| (0..width).map(move |x| [x, y, z])).collect()
    }

    fn index(&self, place: Place) -> Option<usize> {
        let inside =
            |axis: usize| usize::try_from(place[axis]).ok().filter(|&position| position < self.extent[axis]);
        let [x, y, z] = [inside(0)?, inside(1)?, inside(2)?];
        Some(x + self.extent[0] * (y + self.extent[1] * z))
    }

    /// The value at a place, if there is one.
    pub(super) fn get(&self, place: Place) -> Option<i32> {
        self.index(place).map(|index| self.values[index])
    }

    /// The value at a place within.
    pub(super) fn at(&self, place: Place) -> i32 {
        self.get(place).expect("a place within")
    }

    /// The value at the place within that is nearest along each axis.
    pub(in crate::oracle) fn nearest(&self, place: Place) -> i32 {
        let last = self.extent.map(|n| n.cast_signed() - 1);
        self.at([0, 1, 2].map(|axis| place[axis].clamp(0, last[axis])))
    }

    pub(super) fn set(&mut self, place: Place, value: i32) {
        let index = self.index(place).expect("a place within");
        self.values[index] = value;
    }

    /// The subbands of a level in Mallat order, by orientation: 0 is the low-pass part.
    pub(super) fn split(&self) -> [Self; 8] {
        subbands(self.extent).map(|(origin, extent)| {
            let mut subband = Self::zeros(extent);
            for place in subband.places() {
                subband.set(place, self.at([0, 1, 2].map(|axis| origin[axis] + place[axis])));
            }
            subband
        })
    }

    /// Undoes [`Array::split`].
    pub(super) fn join(level: &[Self; 8], extent: [usize; 3]) -> Self {
        let mut whole = Self::zeros(extent);
        for (subband, (origin, _)) in level.iter().zip(subbands(extent)) {
            for place in subband.places() {
                whole.set([0, 1, 2].map(|axis| origin[axis] + place[axis]), subband.at(place));
            }
        }
        whole
    }
}

/// Origin and extent of every subband, and of the low-pass part, of a level of this extent.
pub(super) fn subbands(extent: [usize; 3]) -> [(Place, [usize; 3]); 8] {
    let low = extent.map(|n| n.div_ceil(2));
    [0, 1, 2, 3, 4, 5, 6, 7].map(|orientation| {
        let high = |axis: usize| orientation >> axis & 1 == 1;
        (
            [0, 1, 2].map(|axis| if high(axis) { low[axis].cast_signed() } else { 0 }),
            [0, 1, 2].map(|axis| if high(axis) { extent[axis] - low[axis] } else { low[axis] }),
        )
    })
}
