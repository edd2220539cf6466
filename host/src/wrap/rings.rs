//! The neighbours of every vertex, in order around it, and what each vertex is allowed to do.

use std::collections::HashMap;

use rayon::prelude::*;

use super::WrapError;
use crate::mesh::{Faces, Features, Point};

/// What a vertex of a mesh is (Vis2000 §3.4, §4.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Inside the surface, where it is smooth.
    Smooth,
    /// On a sharp edge or the boundary, with its two neighbours there.
    Crease([u32; 2]),
    /// A sharp vertex, or where sharp edges meet or end.
    Fixed,
}

/// Edge neighbours as compressed rows, counter-clockwise seen from outside.
///
/// The row of a vertex with k faces has k + 1 entries, each face lying between two consecutive ones: inside the surface
/// the last entry is the first one again, on the boundary the first and the last one are the ends of boundary edges.
#[derive(Debug)]
pub(super) struct Rings {
    /// Where the row of each vertex begins, and the end of the last.
    starts: Vec<u32>,
    around: Vec<u32>,
    kinds: Vec<Kind>,
}

impl Rings {
    /// Neighbours in a mesh whose corners are all below `vertices`. Cost: two passes over the corners.
    ///
    /// # Errors
    /// [`WrapError::NotManifold`] where the faces of a vertex are not one fan, [`WrapError::LooseVertex`] where there is
    /// none.
    pub(super) fn new(vertices: usize, faces: &Faces, features: &Features) -> Result<Self, WrapError> {
        let (starts, mut corners) = corners_of_vertices(vertices, faces);
        let mut around = vec![0; corners.len() + vertices];
        let mut rows = Vec::with_capacity(vertices);
        let (mut corners_left, mut around_left) = (corners.as_mut_slice(), around.as_mut_slice());
        for &[start, end] in starts.array_windows() {
            let faces = (end - start) as usize;
            rows.push((
                corners_left.split_off_mut(..faces).expect("as many as counted"),
                around_left.split_off_mut(..=faces).expect("one more than faces"),
            ));
        }
        let broken = rows
            .into_par_iter()
            .enumerate()
            .filter_map(|(vertex, (corners, row))| Some((vertex, chain(corners, row).err()?)))
            .min_by_key(|&(vertex, _)| vertex);
        match broken {
            Some((vertex, Broken::Fans)) => return Err(WrapError::NotManifold { vertex }),
            Some((vertex, Broken::Loose)) => return Err(WrapError::LooseVertex { vertex }),
            None => {}
        }
        let starts = (0..).zip(starts).map(|(vertex, start)| start + vertex).collect();
        let mut rings = Self { starts, around, kinds: Vec::new() };
        rings.kinds = rings.classify(features);
        Ok(rings)
    }

    fn classify(&self, features: &Features) -> Vec<Kind> {
        let mut sharp = HashMap::<u32, Vec<u32>>::new();
        for &[from, to] in &features.edges {
            sharp.entry(from).or_default().push(to);
            sharp.entry(to).or_default().push(from);
        }
        let kind =
            |vertex: usize| match (sharp.get(&(vertex as u32)).map(Vec::as_slice), self.is_closed(vertex)) {
                _ if features.vertices.binary_search(&(vertex as u32)).is_ok() => Kind::Fixed,
                (None, true) => Kind::Smooth,
                (None, false) => Kind::Crease(self.ends(vertex)),
                (Some(&[before, after]), true) => Kind::Crease([before, after]),
                (Some(_), _) => Kind::Fixed,
            };
        (0..self.len()).map(kind).collect()
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The row of a vertex: each face of it lies between two consecutive neighbours.
    pub(super) fn row(&self, vertex: usize) -> &[u32] {
        &self.around[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Whether faces lie all around a vertex.
    pub(super) fn is_closed(&self, vertex: usize) -> bool {
        let row = self.row(vertex);
        row[0] == row[row.len() - 1]
    }

    /// Neighbours of a vertex, each once.
    pub(super) fn neighbours(&self, vertex: usize) -> &[u32] {
        let row = self.row(vertex);
        &row[usize::from(self.is_closed(vertex))..]
    }

    /// First and last entry of a row.
    pub(super) fn ends(&self, vertex: usize) -> [u32; 2] {
        let row = self.row(vertex);
        [row[0], row[row.len() - 1]]
    }

    /// What a vertex is.
    pub(super) fn kind(&self, vertex: usize) -> Kind {
        self.kinds[vertex]
    }

    /// Makes a vertex a fixed one.
    pub(super) fn fix(&mut self, vertex: usize) {
        self.kinds[vertex] = Kind::Fixed;
    }

    /// The sum of the cross products of consecutive edges at a vertex: along its normal, in length twice the area of the
    /// triangles between them (Dataflow §3).
    pub(super) fn normal(&self, vertex: usize, positions: &[Point]) -> Point {
        let centre = positions[vertex];
        let spokes =
            self.row(vertex).array_windows().map(|pair| pair.map(|end| positions[end as usize] - centre));
        spokes.map(|[from, to]| from.cross(to)).sum()
    }

    /// How many triangles between consecutive edges would face against `normal` if the vertex were at `place`.
    pub(super) fn turned(&self, vertex: usize, positions: &[Point], place: Point, normal: Point) -> usize {
        let spokes =
            self.row(vertex).array_windows().map(|pair| pair.map(|end| positions[end as usize] - place));
        spokes.filter(|[from, to]| from.cross(*to).dot(normal) <= 0.0).count()
    }

    /// Mean length of the edges at a vertex.
    pub(super) fn edge_length(&self, vertex: usize, positions: &[Point]) -> f64 {
        let neighbours = self.neighbours(vertex);
        let lengths = neighbours.iter().map(|&end| positions[end as usize].distance(positions[vertex]));
        lengths.sum::<f64>() / neighbours.len() as f64
    }
}

/// For each corner of each face, sorted by its vertex, the next corner of the face and the one before; and where those of
/// each vertex begin.
fn corners_of_vertices(vertices: usize, faces: &Faces) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut starts = vec![0_u32; vertices + 1];
    for &corner in faces.corners() {
        starts[corner as usize + 1] += 1;
    }
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut free = starts.clone();
    let mut corners = vec![[0; 2]; faces.corners().len()];
    for face in faces.iter() {
        let last = face.len() - 1;
        for (place, &corner) in face.iter().enumerate() {
            let before = face[if place == 0 { last } else { place - 1 }];
            let next = face[if place == last { 0 } else { place + 1 }];
            corners[free[corner as usize] as usize] = [next, before];
            free[corner as usize] += 1;
        }
    }
    (starts, corners)
}

enum Broken {
    Fans,
    Loose,
}

/// Puts the faces of a vertex, each given by the neighbours that it lies between, in order around it.
///
/// A closed ring begins at the least neighbour, so that it does not depend on the order of the faces.
fn chain(corners: &mut [[u32; 2]], row: &mut [u32]) -> Result<(), Broken> {
    corners.sort_unstable();
    if corners.array_windows().any(|[one, other]| one[0] == other[0]) {
        return Err(Broken::Fans);
    }
    let follower = |end| corners.binary_search_by_key(&end, |&[from, _]| from).ok();
    let mut followed = vec![false; corners.len()];
    for &[_, to] in &*corners {
        if let Some(next) = follower(to) {
            if followed[next] {
                return Err(Broken::Fans);
            }
            followed[next] = true;
        }
    }
    let first = followed.iter().position(|followed| !followed).unwrap_or(0);
    let mut here = *corners.get(first).ok_or(Broken::Loose)?;
    row[0] = here[0];
    for (place, entry) in row[1..].iter_mut().enumerate() {
        *entry = here[1];
        if place + 1 < corners.len() {
            here = corners[follower(here[1]).ok_or(Broken::Fans)?];
            if here == corners[first] {
                return Err(Broken::Fans);
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(faces: &[&[u32]]) -> Faces {
        faces.iter().copied().collect()
    }

    #[test]
    fn rings_run_counter_clockwise() {
        let tetrahedron = mesh(&[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]]);
        let rings = Rings::new(4, &tetrahedron, &Features::default()).unwrap();
        assert_eq!(rings.row(0), [1, 2, 3, 1]);
        assert_eq!(rings.neighbours(0), [2, 3, 1]);
        assert!((0..4).all(|vertex| rings.kind(vertex) == Kind::Smooth));
    }

    #[test]
    fn rings_of_the_boundary_are_open() {
        let rings = Rings::new(5, &mesh(&[&[0, 1, 2, 3], &[1, 4, 2]]), &Features::default()).unwrap();
        assert_eq!(rings.row(0), [1, 3]);
        assert_eq!(rings.row(1), [4, 2, 0]);
        assert_eq!(rings.row(2), [3, 1, 4]);
        assert_eq!(rings.kind(1), Kind::Crease([4, 0]));
        let plane = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.5]];
        let plane = plane.map(|[x, y]| Point::new(x, y, 0.0));
        assert_eq!(rings.normal(0, &plane), Point::Z);
        assert_eq!(rings.edge_length(0, &plane), 1.0);
    }

    #[test]
    fn features_make_creases_and_corners() {
        let fan = mesh(&[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4], &[0, 4, 1]]);
        let kind = |features: Features| Rings::new(5, &fan, &features).unwrap().kind(0);
        let sharp = |edges: &[[u32; 2]]| Features { edges: edges.to_vec(), vertices: Vec::new() };
        assert_eq!(kind(sharp(&[[0, 1], [0, 3]])), Kind::Crease([1, 3]));
        assert_eq!(kind(sharp(&[[0, 1]])), Kind::Fixed);
        assert_eq!(kind(Features { edges: Vec::new(), vertices: vec![0] }), Kind::Fixed);
    }

    #[test]
    fn what_is_no_manifold_is_refused() {
        let refused = |vertices, faces: &[&[u32]]| {
            Rings::new(vertices, &mesh(faces), &Features::default()).expect_err("not a manifold")
        };
        let bow_tie = refused(5, &[&[0, 1, 2], &[0, 3, 4]]);
        assert!(matches!(bow_tie, WrapError::NotManifold { vertex: 0 }));
        let three_sides = refused(5, &[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]]);
        assert!(matches!(three_sides, WrapError::NotManifold { vertex: 0 }));
        let wound_two_ways = refused(4, &[&[0, 1, 2], &[0, 1, 3]]);
        assert!(matches!(wound_two_ways, WrapError::NotManifold { vertex: 0 }));
        let two_rings: &[&[u32]] = &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 1], &[0, 4, 5], &[0, 5, 6], &[0, 6, 4]];
        assert!(matches!(refused(7, two_rings), WrapError::NotManifold { vertex: 0 }));
        assert!(matches!(refused(4, &[&[0, 1, 2]]), WrapError::LooseVertex { vertex: 3 }));
    }
}
