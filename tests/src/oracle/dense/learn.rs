//! How the weights of a prediction are learnt: sums of products, and the equations that they make.

use super::Kind;

/// Products of all pairs of observations: row i has those with 0 to i, the last row those with the target.
type Sums = Vec<Vec<i32>>;

fn zeros(unknowns: usize) -> Sums {
    (1..=unknowns).chain([unknowns]).map(|len| vec![0; len]).collect()
}

fn combine(sums: &Sums, others: &Sums, f: impl Fn(i32, i32) -> i32) -> Sums {
    let row = |(row, other): (&Vec<i32>, &Vec<i32>)| row.iter().zip(other).map(|(&a, &b)| f(a, b)).collect();
    sums.iter().zip(others).map(row).collect()
}

/// What a column of a plane has learnt.
#[derive(Debug, Clone)]
struct Column {
    fast_sums: Sums,
    slow_sums: Sums,
    solved: u32,
    fast: Vec<i32>,
    slow: Vec<i32>,
}

/// All columns of a kind of row, and the memory of observations.
#[derive(Debug)]
pub(super) struct Learner {
    kind: Kind,
    extent: [usize; 3],
    columns: Vec<Column>,
    groups: usize,
    group_rows: usize,
    /// Of each column, since the current group began.
    current: Vec<Sums>,
    /// Of each group and column, in the plane before.
    remembered: Vec<Vec<Sums>>,
    observations: Vec<(Vec<i32>, i32)>,
}

impl Learner {
    pub(super) fn new(kind: Kind, extent: [usize; 3]) -> Self {
        let [width, height, _] = extent;
        let columns = width.div_ceil(64).min(8);
        let groups = 16 / columns;
        let (unknowns, first) = kind.first_weights();
        let none = zeros(unknowns);
        let column = Column {
            fast_sums: none.clone(),
            slow_sums: none.clone(),
            solved: 0,
            fast: first.clone(),
            slow: first,
        };
        Self {
            kind,
            extent,
            columns: vec![column; columns],
            groups,
            group_rows: height.div_ceil(groups),
            current: vec![none.clone(); columns],
            remembered: vec![vec![none; columns]; groups],
            observations: Vec::new(),
        }
    }

    /// Samples of a chunk, but of the last.
    pub(super) fn chunk_len(&self) -> usize {
        self.extent[0].div_ceil(self.chunks())
    }

    fn chunks(&self) -> usize {
        self.extent[0].div_ceil(64)
    }

    fn column_of(&self, x: usize) -> usize {
        x / self.chunk_len() * self.columns.len() / self.chunks()
    }

    /// The fast and the slow weights at x.
    pub(super) fn weights(&self, x: usize) -> [&[i32]; 2] {
        let column = &self.columns[self.column_of(x)];
        [&column.fast, &column.slow]
    }

    /// Takes what was seen at (x, y, z), and learns where a chunk ends.
    pub(super) fn observe(&mut self, [x, y, z]: [usize; 3], differences: &[i32], target: i32) {
        let observed = |value: i32| value.wrapping_add(32) >> 6;
        let differences = differences.iter().map(|&d| i32::from(observed(d) as i16)).collect();
        self.observations.push((differences, observed(target).clamp(-512, 512)));
        let [width, height, _] = self.extent;
        if (x + 1) % self.chunk_len() == 0 || x + 1 == width {
            let column = self.column_of(x);
            let room = self.observations.len() + self.chunk_len() <= 64;
            if !(room && y + 1 < height && self.columns[column].solved >= 16) {
                self.look(column, y, z);
            }
        }
        if x + 1 == width && self.kind == Kind::Brick && ((y + 1) % self.group_rows == 0 || y + 1 == height) {
            let none = vec![zeros(self.kind.first_weights().0); self.columns.len()];
            self.remembered[y / self.group_rows] = std::mem::replace(&mut self.current, none);
        }
    }

    fn look(&mut self, number: usize, y: usize, z: usize) {
        let observations = std::mem::take(&mut self.observations);
        let tells = observations.iter().any(|(s, target)| *target != 0 || s[0] != 0);
        if !tells || (self.kind == Kind::Brick && y == 0) {
            return;
        }
        let products = products(&observations);
        let column = &mut self.columns[number];
        let decay =
            |factor: i32| move |s: i32, p: i32| s.wrapping_sub((s >> 8).wrapping_mul(factor)).wrapping_add(p);
        column.slow_sums = combine(&column.slow_sums, &products, decay(2));
        column.fast_sums = combine(&column.fast_sums, &products, decay(128));
        if column.solved < 16 || column.solved.is_multiple_of(4) {
            column.slow = solve(&column.slow_sums);
        }
        column.solved += 1;
        let group = (y + 1) / self.group_rows;
        column.fast = if z > 1 && group < self.groups {
            let remembered = &self.remembered[group][number];
            let add = |s: i32, r: i32| s.wrapping_add((r >> 2).wrapping_mul(3));
            solve(&combine(&column.fast_sums, remembered, add))
        } else {
            solve(&column.fast_sums)
        };
        if self.kind == Kind::Brick {
            self.current[number] = combine(&self.current[number], &products, i32::wrapping_add);
        }
    }
}

fn products(observations: &[(Vec<i32>, i32)]) -> Sums {
    let unknowns = observations[0].0.len();
    let mut sums = zeros(unknowns);
    for (s, target) in observations {
        for i in 0..unknowns {
            for j in 0..=i {
                sums[i][j] += s[i] * s[j];
            }
            sums[unknowns][i] += s[i] * target;
        }
    }
    sums
}

/// The low 32 bits of a sum shifted by 16.
fn shifted(sum: i64) -> i32 {
    (sum >> 16) as i32
}

fn solve(sums: &Sums) -> Vec<i32> {
    let unknowns = sums.len() - 1;
    let mut a = sums.clone();
    for (i, row) in a[..unknowns].iter_mut().enumerate() {
        row[i] = row[i].saturating_add(row[i] >> 12).saturating_add(4096);
    }
    let bits = (0..unknowns).fold(0, |or, i| or | a[i][i].unsigned_abs() | a[unknowns][i].unsigned_abs());
    let zeros = bits.leading_zeros();
    let (up, down) = (zeros.saturating_sub(2), 2_u32.saturating_sub(zeros));
    a.iter_mut().flatten().for_each(|entry| *entry = *entry << up >> down);
    let (mut factors, mut inverses): (Vec<Vec<i32>>, Vec<i64>) = (Vec::new(), Vec::new());
    for (i, entries) in a.iter().enumerate() {
        let (mut parts, mut row): (Vec<i32>, Vec<i32>) = (Vec::new(), Vec::new());
        for j in 0..i {
            let part = entries[j].wrapping_sub(shifted(dot(&parts, &factors[j])));
            let factor = i64::from(part).wrapping_mul(inverses[j]) >> 30;
            parts.push(part);
            row.push(factor.clamp(-i64::from(i32::MAX), i64::from(i32::MAX)) as i32);
        }
        if i < unknowns {
            let rest = entries[i].wrapping_sub(shifted(dot(&parts, &row)));
            inverses.push((1 << 46) / i64::from(rest.max(1)));
        }
        factors.push(row);
    }
    let mut x = factors[unknowns].clone();
    let mut weights = vec![0; unknowns];
    for i in (0..unknowns).rev() {
        let solved = x[i].clamp(-524_224, 524_224);
        for j in 0..i {
            x[j] = x[j].wrapping_sub(shifted(i64::from(factors[i][j]) * i64::from(solved)));
        }
        weights[i] = (solved + 8) >> 4;
    }
    weights
}

/// The sum of products, as far as both go.
fn dot(a: &[i32], b: &[i32]) -> i64 {
    a.iter().zip(b).fold(0, |sum, (&a, &b)| sum.wrapping_add(i64::from(a) * i64::from(b)))
}
