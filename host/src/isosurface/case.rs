//! What the surface in a cell looks like, for each way in which its corners are inside and joined.

use std::sync::LazyLock;

use super::cell::{self, CORNERS, EDGES, FACES};
use super::decide::{self, Joined};

/// Places that corners of triangles in a cell may have: its edges, then middles.
pub(super) const PLACES: usize = 16;

/// The triangles of a cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Pattern {
    /// Corners of each triangle: edges of the cell, or [`EDGES`] + n for the middle of loop n of `middles`; all are below
    /// [`PLACES`].
    pub(super) triangles: Vec<[u8; 3]>,
    /// The edges whose vertices have a vertex in the middle; some edges twice or more, where they weigh more.
    pub(super) middles: Vec<Vec<u8>>,
}

/// Two loops that may bound a tube.
#[derive(Clone, Debug)]
struct Tube {
    /// A corner of each of the two sets which the tube joins.
    corners: [u8; 2],
    pattern: Pattern,
}

/// How faces are decided, and what follows.
#[derive(Clone, Debug)]
struct Decision {
    /// What is joined on the border of the cell.
    joined: Joined,
    /// All loops bound disks.
    disks: Pattern,
    /// One tube, the other loops bound disks.
    tubes: Vec<Tube>,
}

/// All cells with the same inside corners.
#[derive(Clone, Debug)]
enum Case {
    /// All of them look the same.
    Certain(Pattern),
    /// Values decide.
    Open {
        /// Faces on which inside and outside corners alternate.
        ambiguous: Vec<usize>,
        /// For each set of joined faces among them, as bits.
        decisions: Vec<Decision>,
    },
}

/// All cases.
#[derive(Debug)]
pub(super) struct Cases {
    cases: Vec<Case>,
}

static CASES: LazyLock<Cases> = LazyLock::new(|| Cases { cases: (0..=u8::MAX).map(Case::new).collect() });

impl Cases {
    /// The only table, derived on first use.
    pub(super) fn get() -> &'static Self {
        &CASES
    }

    /// The triangles of a cell whose inside corners are the bits of `inside`, if they alone decide.
    pub(super) fn certain(&self, inside: u8) -> Option<&Pattern> {
        match &self.cases[usize::from(inside)] {
            Case::Certain(pattern) => Some(pattern),
            Case::Open { .. } => None,
        }
    }

    /// The triangles of a cell with values relative to the isovalue, which agree with the bits of `inside`.
    pub(super) fn decide(&self, inside: u8, values: &[f64; CORNERS]) -> &Pattern {
        let (ambiguous, decisions) = match &self.cases[usize::from(inside)] {
            Case::Certain(pattern) => return pattern,
            Case::Open { ambiguous, decisions } => (ambiguous, decisions),
        };
        let bits = ambiguous.iter().enumerate();
        let faces: usize =
            bits.map(|(bit, &face)| usize::from(decide::joined_across(values, face)) << bit).sum();
        let decision = &decisions[faces];
        if decision.tubes.is_empty() {
            return &decision.disks;
        }
        let mut joined = decision.joined;
        decide::join_through(values, &mut joined);
        let found = decision.tubes.iter().find(|tube| {
            let [a, b] = tube.corners.map(|corner| joined.set(usize::from(corner)));
            a == b
        });
        found.map_or(&decision.disks, |tube| &tube.pattern)
    }
}

impl Case {
    fn new(inside: u8) -> Self {
        let ambiguous: Vec<usize> = (0..FACES)
            .filter(|&face| {
                let [a, b, c, d] = cell::face_corners(face).map(|corner| inside >> corner & 1);
                a == c && b == d && a != b
            })
            .collect();
        let decisions = (0..1_usize << ambiguous.len()).map(|bits| {
            let joined_faces = ambiguous.iter().enumerate().filter(|(bit, _)| bits >> bit & 1 == 1);
            Decision::new(inside, &joined_faces.map(|(_, &face)| face).collect::<Vec<_>>())
        });
        let mut decisions: Vec<Decision> = decisions.collect();
        match &mut decisions[..] {
            [only] if only.tubes.is_empty() => Self::Certain(std::mem::take(&mut only.disks)),
            _ => Self::Open { ambiguous, decisions },
        }
    }
}

impl Decision {
    fn new(inside: u8, joined_faces: &[usize]) -> Self {
        let joined = joined_on_border(inside, joined_faces);
        let loops = loops(inside, joined_faces);
        // The inside and the outside set that each loop separates.
        let sides: Vec<[u8; 2]> = loops
            .iter()
            .map(|edges| {
                let [a, b] = cell::ends(usize::from(edges[0]));
                let (within, beyond) = if inside >> a & 1 == 1 { (a, b) } else { (b, a) };
                [joined.set(within), joined.set(beyond)]
            })
            .collect();
        let pairs = (0..loops.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        let tubes = pairs.filter_map(|[a, b]| {
            // A tube joins the two sets on one side of its loops, whose other side is the same.
            let side = (0..2)
                .find(|&side| sides[a][side] != sides[b][side] && sides[a][1 - side] == sides[b][1 - side])?;
            let corners = [sides[a][side], sides[b][side]];
            let rest = (0..loops.len()).filter(|&other| other != a && other != b);
            let mut pattern = disks(rest.map(|other| &loops[other][..]));
            match tube(&loops[a], &loops[b]) {
                Some(triangles) => pattern.triangles.extend(triangles),
                None => add_waist(&loops[a], &loops[b], &mut pattern),
            }
            Some(Tube { corners, pattern })
        });
        Self { tubes: tubes.collect(), disks: disks(loops.iter().map(Vec::as_slice)), joined }
    }
}

/// Corners joined along edges, and across faces: inside ones across `joined_faces`, outside ones across other faces.
fn joined_on_border(inside: u8, joined_faces: &[usize]) -> Joined {
    let side = |corner: usize| inside >> corner & 1 == 1;
    let mut joined = Joined::new();
    for [a, b] in (0..EDGES).map(cell::ends).filter(|&[a, b]| side(a) == side(b)) {
        joined.join(a, b);
    }
    for face in 0..FACES {
        let [a, b, c, d] = cell::face_corners(face);
        for [one, other] in [[a, c], [b, d]] {
            if side(one) == side(other) && side(one) == joined_faces.contains(&face) {
                joined.join(one, other);
            }
        }
    }
    joined
}

/// The loops in which the surface meets the border of the cell, as edges in the order of its triangles' sides.
fn loops(inside: u8, joined_faces: &[usize]) -> Vec<Vec<u8>> {
    let side = |corner: usize| inside >> corner & 1 == 1;
    let mut next = [None; EDGES];
    for face in 0..FACES {
        let (corners, edges) = (cell::face_corners(face), cell::face_edges(face));
        let enters = |n: usize| !side(corners[n]) && side(corners[(n + 1) % 4]);
        let leaves = |n: usize| side(corners[n]) && !side(corners[(n + 1) % 4]);
        for entry in (0..4).filter(|&n| enters(n)) {
            // A segment cuts off the inside corners after its start, or the outside ones before it.
            let mut steps: Box<dyn Iterator<Item = usize>> =
                if joined_faces.contains(&face) { Box::new((1..4).rev()) } else { Box::new(1..4) };
            let exit = steps.find_map(|step| leaves((entry + step) % 4).then_some((entry + step) % 4));
            next[edges[entry]] = exit.map(|exit| edges[exit]);
        }
    }
    let mut loops = Vec::new();
    for start in 0..EDGES {
        let mut edges = Vec::new();
        let mut edge = start;
        while let Some(following) = next[edge].take() {
            edges.push(edge as u8);
            edge = following;
        }
        if !edges.is_empty() {
            loops.push(edges);
        }
    }
    loops
}

/// Squared length of a new side between two edges of the cell, `None` if it would lie on a face.
fn length(a: u8, b: u8) -> Option<i32> {
    let (a, b) = (usize::from(a), usize::from(b));
    let squares = cell::middle(a).into_iter().zip(cell::middle(b)).map(|(a, b)| (a - b).pow(2));
    (!cell::share_face(a, b)).then(|| squares.sum())
}

/// Triangulated disks.
fn disks<'a>(loops: impl Iterator<Item = &'a [u8]>) -> Pattern {
    let mut pattern = Pattern::default();
    for edges in loops {
        let last = edges.len() - 1;
        if let Some((_, triangles)) = polygon(edges, 0, last) {
            pattern.triangles.extend(triangles);
        } else {
            let middle = (EDGES + pattern.middles.len()) as u8;
            pattern.triangles.extend((0..=last).map(|n| [edges[n], edges[(n + 1) % (last + 1)], middle]));
            pattern.middles.push(edges.to_vec());
        }
    }
    pattern
}

/// The triangulation of corners `from` to `to` of a loop with the shortest new sides, and their squared lengths; `None` if
/// there is none without a side on a face.
fn polygon(edges: &[u8], from: usize, to: usize) -> Option<(i32, Vec<[u8; 3]>)> {
    let cost = |a: usize, b: usize| if b - a == 1 { Some(0) } else { length(edges[a], edges[b]) };
    if to - from < 2 {
        return Some((0, Vec::new()));
    }
    let choices = (from + 1..to).filter_map(|top| {
        let sides = cost(from, top)? + cost(top, to)?;
        let (left, mut triangles) = polygon(edges, from, top)?;
        let (right, others) = polygon(edges, top, to)?;
        triangles.push([edges[from], edges[top], edges[to]]);
        triangles.extend(others);
        Some((sides + left + right, triangles))
    });
    choices.min_by_key(|(length, _)| *length)
}

/// The triangulation of a tube between two loops with the shortest new sides, `None` if each has a side on a face.
///
/// One loop is followed forwards and the other backwards: they are the borders of one surface.
fn tube(one: &[u8], other: &[u8]) -> Option<Vec<[u8; 3]>> {
    let choices = (0..other.len()).filter_map(|turn| {
        let backwards: Vec<u8> =
            (0..=other.len()).map(|n| other[(turn + other.len() - n) % other.len()]).collect();
        let forwards: Vec<u8> = one.iter().chain(&one[..1]).copied().collect();
        strip(&forwards, &backwards).filter(|(_, triangles)| sides_differ(triangles))
    });
    choices.min_by_key(|(length, _)| *length).map(|(_, triangles)| triangles)
}

/// Adds a tube between two loops with three vertices around its waist, which needs no side between the loops: it is made of
/// a strip from each loop to the waist.
fn add_waist(one: &[u8], other: &[u8], pattern: &mut Pattern) {
    let gap = |edge: u8| {
        let ends = cell::middle(usize::from(one[0])).into_iter().zip(cell::middle(usize::from(edge)));
        ends.map(|(a, b)| (a - b).pow(2)).sum::<i32>()
    };
    let turn = (0..other.len()).min_by_key(|&n| gap(other[n])).unwrap_or(0);
    let other = [&other[turn..], &other[..turn]].concat();
    let first = EDGES + pattern.middles.len();
    // Vertices of the waist are between a third of each loop, and drawn inwards so that none lies on a face.
    let mut waist = vec![[one, &other].concat(); 3];
    // The loops turn against each other.
    for (edges, order) in [(one, [0, 1, 2]), (&other[..], [0, 2, 1])] {
        let count = edges.len();
        let third = |n: usize| order[n % count * 3 / count];
        for n in 0..count {
            let [this, next] = [third(n), third(n + 1)];
            waist[this].extend([edges[n]; 2]);
            let [low, high] = [this, next].map(|third| (first + third) as u8);
            pattern.triangles.push([edges[n], edges[(n + 1) % count], low]);
            if this != next {
                pattern.triangles.push([low, edges[(n + 1) % count], high]);
            }
        }
    }
    pattern.middles.extend(waist);
}

/// Whether no side is used twice in the same direction.
fn sides_differ(triangles: &[[u8; 3]]) -> bool {
    let mut sides: Vec<_> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.sort_unstable();
    sides.array_windows().all(|[one, next]| one != next)
}

/// The strip of triangles between two rows with the shortest sides from row to row, and their squared lengths.
fn strip(above: &[u8], below: &[u8]) -> Option<(i32, Vec<[u8; 3]>)> {
    let (last_a, last_b) = (above.len() - 1, below.len() - 1);
    // The best strip up to each side, in the order in which sides can follow each other.
    let mut best: Vec<Option<(i32, Vec<[u8; 3]>)>> = vec![None; above.len() * below.len()];
    for (a, b) in (0..=last_a).flat_map(|a| (0..=last_b).map(move |b| (a, b))) {
        let at = |a: usize, b: usize| best[a * below.len() + b].clone();
        let so_far = if (a, b) == (0, 0) {
            Some((0, Vec::new()))
        } else {
            let from_above = (a > 0).then(|| at(a - 1, b)).flatten().map(|(length, mut triangles)| {
                triangles.push([above[a - 1], above[a], below[b]]);
                (length, triangles)
            });
            let from_below = (b > 0).then(|| at(a, b - 1)).flatten().map(|(length, mut triangles)| {
                triangles.push([below[b], below[b - 1], above[a]]);
                (length, triangles)
            });
            from_above.into_iter().chain(from_below).min_by_key(|(length, _)| *length)
        };
        let side = length(above[a], below[b]);
        best[a * below.len() + b] = so_far.zip(side).map(|((length, t), side)| (length + side, t));
    }
    best.pop().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Case {
        fn patterns(&self) -> Vec<&Pattern> {
            match self {
                Self::Certain(pattern) => vec![pattern],
                Self::Open { decisions, .. } => {
                    let tubes = decisions.iter().flat_map(|decision| &decision.tubes);
                    let disks = decisions.iter().map(|decision| &decision.disks);
                    tubes.map(|tube| &tube.pattern).chain(disks).collect()
                }
            }
        }
    }

    #[test]
    fn sides_are_used_once_each_way() {
        let patterns = Cases::get().cases.iter().flat_map(Case::patterns);
        assert!(patterns.clone().count() > 256);
        for pattern in patterns {
            assert!(sides_differ(&pattern.triangles), "{pattern:?}");
            let corners = pattern.triangles.iter().flatten();
            assert!(corners.clone().all(|&corner| usize::from(corner) < PLACES));
        }
    }
}
