//! A tree of boxes over the triangles of a mesh, for closest points and for pairs of triangles that may meet.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::{Bounds, Triangle};
use crate::mesh::{Point, TriangleMesh};

/// Triangles of a leaf.
const LEAF: usize = 4;

/// Leaves below which a subtree is built by one thread.
const SERIAL_LEAVES: usize = 1024;

/// Queries that are answered one after another, each beginning with the triangle of the one before.
const RUN: usize = 256;

/// Nodes that wait on the way through a tree: one a level, of which there are at most 32.
const PENDING: usize = 34;

/// Boxes in a balanced binary tree, in depth-first order: the left child of a node follows it.
///
/// Which triangles a node stands for follows from its place, since all leaves are full but the last one.
#[derive(Clone, Debug)]
pub struct Bvh {
    boxes: Vec<Bounds>,
    /// Leaf after leaf.
    triangles: Vec<Triangle>,
    /// Where each of `triangles` stands in the mesh.
    indices: Vec<u32>,
}

/// The point of a mesh that is closest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The point.
    pub point: Point,
    /// The triangle that it lies on; one of them, if it is on an edge.
    pub triangle: u32,
    /// Barycentric coordinates in that triangle; zeros as in [`Nearest::weights`](super::Nearest::weights).
    pub weights: [f64; 3],
    /// Squared distance from the given point.
    pub distance_squared: f64,
}

/// A node, with the leaves below it.
#[derive(Clone, Copy, Debug)]
struct Node {
    place: usize,
    first_leaf: usize,
    leaves: usize,
}

impl Node {
    fn children(self) -> [Self; 2] {
        let left = self.leaves / 2;
        [
            Self { place: self.place + 1, first_leaf: self.first_leaf, leaves: left },
            Self {
                place: self.place + 2 * left,
                first_leaf: self.first_leaf + left,
                leaves: self.leaves - left,
            },
        ]
    }
}

impl Bvh {
    /// Sorts the triangles of a mesh, whose positions are finite, into a tree.
    ///
    /// Cost: O(n log n), about 0.4 s for a million triangles on two cores; 100 bytes a triangle.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let corners = |triangle: &[u32; 3]| Triangle(triangle.map(|corner| mesh.positions[corner as usize]));
        let mut items: Vec<Item> = mesh
            .triangles
            .par_iter()
            .enumerate()
            .map(|(index, triangle)| {
                let bounds = Bounds::around(corners(triangle).0);
                Item { centre: bounds.centre(), index: index as u32 }
            })
            .collect();
        let leaves = items.len().div_ceil(LEAF);
        sort(&mut items, leaves);
        let indices: Vec<u32> = items.into_iter().map(|item| item.index).collect();
        let triangles: Vec<Triangle> =
            indices.par_iter().map(|&index| corners(&mesh.triangles[index as usize])).collect();
        let mut boxes = vec![Bounds::NONE; (2 * leaves).saturating_sub(1)];
        if leaves > 0 {
            enclose(&mut boxes, &triangles);
        }
        Self { boxes, triangles, indices }
    }

    /// Box around all triangles.
    pub fn bounds(&self) -> Bounds {
        self.boxes.first().copied().unwrap_or(Bounds::NONE)
    }

    /// The closest point of the mesh; none if it has no triangles or `point` is not finite.
    pub fn closest(&self, point: Point) -> Option<Closest> {
        self.closest_within(point, f64::INFINITY)
    }

    /// The closest point of the mesh, if its squared distance is below `limit_squared`.
    ///
    /// Cost: some 50 boxes and 10 triangles near the surface, O(log n); much more for points that are as far from many
    /// triangles, as the centre of a sphere. A limit helps there.
    pub fn closest_within(&self, point: Point, limit_squared: f64) -> Option<Closest> {
        let mut best = None;
        self.search(point, limit_squared, &mut best);
        best
    }

    /// Which way the closest triangle faces, if its squared distance is below `limit_squared` and it has an area.
    pub fn facing(&self, point: Point, limit_squared: f64) -> Option<Point> {
        let place = self.search(point, limit_squared, &mut None)?;
        let [a, b, c] = self.triangles[place].0;
        (b - a).cross(c - a).try_normalize()
    }

    /// The closest point for each of many, in order; faster for points that are near those before them.
    ///
    /// Cost: parallel; the result does not depend on the number of threads.
    pub fn closest_all(&self, points: &[Point]) -> Vec<Option<Closest>> {
        let mut all = vec![None; points.len()];
        all.par_chunks_mut(RUN).zip(points.par_chunks(RUN)).for_each(|(found, points)| {
            // Place of the last triangle, for a first guess.
            let mut last = None;
            for (found, &point) in found.iter_mut().zip(points) {
                let guess = last.and_then(|place| self.try_triangle(place, point, f64::INFINITY));
                *found = guess;
                let limit = guess.map_or(f64::INFINITY, |guess| guess.distance_squared);
                last = self.search(point, limit, found).or(last);
            }
        });
        all
    }

    /// Puts a point closer than `limit_squared` into `best`, and returns the place of its triangle.
    fn search(&self, point: Point, mut limit_squared: f64, best: &mut Option<Closest>) -> Option<usize> {
        let mut best_place = None;
        let mut pending = [(0.0, Node { place: 0, first_leaf: 0, leaves: 0 }); PENDING];
        let mut waiting = 0;
        if let Some(root) = self.boxes.first() {
            let node = Node { place: 0, first_leaf: 0, leaves: self.triangles.len().div_ceil(LEAF) };
            pending[0] = (root.distance_squared(point), node);
            waiting = 1;
        }
        while waiting > 0 {
            waiting -= 1;
            let (distance, mut node) = pending[waiting];
            // Not "greater or equal": a distance that is no number ends the search.
            let mut reachable = distance < limit_squared;
            while reachable && node.leaves > 1 {
                let [left, right] = node.children();
                let [to_left, to_right] =
                    [left, right].map(|child| self.boxes[child.place].distance_squared(point));
                let (near, far) = if to_right < to_left {
                    ((to_right, right), (to_left, left))
                } else {
                    ((to_left, left), (to_right, right))
                };
                if far.0 < limit_squared {
                    pending[waiting] = far;
                    waiting += 1;
                }
                reachable = near.0 < limit_squared;
                node = near.1;
            }
            if !reachable {
                continue;
            }
            let first = node.first_leaf * LEAF;
            for place in first..(first + LEAF).min(self.triangles.len()) {
                if let Some(closer) = self.try_triangle(place, point, limit_squared) {
                    limit_squared = closer.distance_squared;
                    *best = Some(closer);
                    best_place = Some(place);
                }
            }
        }
        best_place
    }

    fn try_triangle(&self, place: usize, point: Point, limit_squared: f64) -> Option<Closest> {
        let nearest = self.triangles[place].nearest(point);
        let distance_squared = nearest.point.distance_squared(point);
        (distance_squared < limit_squared).then(|| Closest {
            point: nearest.point,
            triangle: self.indices[place],
            weights: nearest.weights,
            distance_squared,
        })
    }

    /// Calls `visit` with the index of every triangle of a leaf whose box meets `bounds`, until it says to stop.
    pub fn near(&self, bounds: &Bounds, mut visit: impl FnMut(u32) -> ControlFlow<()>) {
        let mut pending = vec![Node { place: 0, first_leaf: 0, leaves: self.triangles.len().div_ceil(LEAF) }];
        while let Some(node) = pending.pop() {
            if node.leaves == 0 || !self.boxes[node.place].overlaps(bounds) {
                continue;
            }
            if node.leaves > 1 {
                pending.extend(node.children());
                continue;
            }
            let first = node.first_leaf * LEAF;
            let leaf = &self.indices[first..(first + LEAF).min(self.indices.len())];
            if leaf.iter().try_for_each(|&index| visit(index)).is_break() {
                return;
            }
        }
    }
}

/// A triangle to be sorted.
#[derive(Clone, Copy, Debug)]
struct Item {
    centre: Point,
    index: u32,
}

/// Brings items into the order of the leaves: halves along the longest axis again and again.
fn sort(items: &mut [Item], leaves: usize) {
    if leaves < 2 {
        return;
    }
    let around = Bounds::around(items.iter().map(|item| item.centre));
    let lengths = (around.high - around.low).to_array();
    let axis = (0..3).fold(0, |best, axis| if lengths[axis] > lengths[best] { axis } else { best });
    let left = leaves / 2;
    items.select_nth_unstable_by(left * LEAF, |a, b| {
        a.centre[axis].total_cmp(&b.centre[axis]).then(a.index.cmp(&b.index))
    });
    let (low, high) = items.split_at_mut(left * LEAF);
    if leaves < SERIAL_LEAVES {
        sort(low, left);
        sort(high, leaves - left);
    } else {
        rayon::join(|| sort(low, left), || sort(high, leaves - left));
    }
}

/// Fills in the boxes of a subtree, and returns that of its root.
fn enclose(boxes: &mut [Bounds], triangles: &[Triangle]) -> Bounds {
    let leaves = triangles.len().div_ceil(LEAF);
    let (root, below) = boxes.split_first_mut().expect("one box a leaf at least");
    *root = if leaves == 1 {
        Bounds::around(triangles.iter().flat_map(|triangle| triangle.0))
    } else {
        let left = leaves / 2;
        let (left_boxes, right_boxes) = below.split_at_mut(2 * left - 1);
        let (left_triangles, right_triangles) = triangles.split_at(left * LEAF);
        let low = enclose(left_boxes, left_triangles);
        let high = enclose(right_boxes, right_triangles);
        low.joined(high)
    };
    *root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_face_along_their_normals() {
        let positions = vec![Point::ZERO, Point::X, Point::Y, Point::Z];
        let tree = Bvh::new(&TriangleMesh { positions, triangles: vec![[0, 1, 2], [0, 3, 3]] });
        assert_eq!(tree.facing(Point::new(0.2, 0.2, -0.1), 1.0), Some(Point::Z));
        assert_eq!(tree.facing(Point::new(0.2, 0.2, -0.1), 0.001), None);
        assert_eq!(tree.facing(Point::new(0.0, 0.0, 2.0), 4.0), None);
    }

    /// Random triangles in the unit cube, some of them large, some without area.
    fn soup(count: u32) -> TriangleMesh {
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut mesh = TriangleMesh::default();
        for triangle in 0..count {
            let size = if triangle % 7 == 0 { 0.5 } else { 0.05 };
            let first = Point::new(random(), random(), random());
            let mut corner = || first + Point::new(random(), random(), random()) * size;
            let corners = if triangle % 11 == 0 { [first; 3] } else { [first, corner(), corner()] };
            mesh.positions.extend(corners);
            mesh.triangles.push([0, 1, 2].map(|corner| triangle * 3 + corner));
        }
        mesh
    }

    fn by_brute_force(mesh: &TriangleMesh, point: Point) -> f64 {
        let distances = mesh.triangles.iter().map(|triangle| {
            let corners = triangle.map(|corner| mesh.positions[corner as usize]);
            Triangle(corners).nearest(point).point.distance_squared(point)
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_closest_of_all_triangles_is_found() {
        for count in [1, 2, 4, 5, 8, 9, 13, 100, 700] {
            let mesh = soup(count);
            let bvh = Bvh::new(&mesh);
            let points: Vec<Point> =
                soup(100).positions.iter().map(|&point| point * 3.0 - Point::ONE).collect();
            for (point, found) in points.iter().zip(bvh.closest_all(&points)) {
                let found = found.unwrap();
                assert_eq!(found.distance_squared, by_brute_force(&mesh, *point), "{count}: {point}");
                let corners =
                    mesh.triangles[found.triangle as usize].map(|corner| mesh.positions[corner as usize]);
                let weighted: Point = (0..3).map(|corner| corners[corner] * found.weights[corner]).sum();
                assert!(weighted.distance(found.point) < 1e-12);
                assert_eq!(bvh.closest(*point).unwrap().distance_squared, found.distance_squared);
                assert_eq!(bvh.closest_within(*point, found.distance_squared), None);
                let wider = bvh.closest_within(*point, found.distance_squared.next_up()).unwrap();
                assert_eq!(wider.distance_squared, found.distance_squared);
            }
        }
    }

    #[test]
    fn nothing_is_closest_in_an_empty_mesh_or_to_no_point() {
        let empty = Bvh::new(&TriangleMesh::default());
        assert_eq!(empty.closest(Point::ZERO), None);
        assert_eq!(empty.bounds(), Bounds::NONE);
        empty.near(&Bounds::around([Point::ZERO]), |_| panic!("no triangle"));
        assert_eq!(Bvh::new(&soup(20)).closest(Point::NAN), None);
        assert_eq!(Bvh::new(&soup(20)).closest_all(&[Point::NAN]), [None]);
    }

    #[test]
    fn every_triangle_near_a_box_is_visited() {
        let mesh = soup(500);
        let bvh = Bvh::new(&mesh);
        let window = Bounds { low: Point::splat(0.3), high: Point::splat(0.5) };
        let mut visited = vec![false; mesh.triangles.len()];
        bvh.near(&window, |triangle| {
            visited[triangle as usize] = true;
            ControlFlow::Continue(())
        });
        for (triangle, visited) in mesh.triangles.iter().zip(&visited) {
            let bounds = Bounds::around(triangle.map(|corner| mesh.positions[corner as usize]));
            assert!(*visited || !bounds.overlaps(&window));
        }
        assert!(visited.iter().filter(|visited| **visited).count() < 250);
    }

    #[test]
    fn threads_do_not_matter() {
        let mesh = soup(5000);
        let points = soup(700).positions;
        let with_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Bvh::new(&mesh).closest_all(&points))
        };
        assert_eq!(with_threads(1), with_threads(4));
    }
}
