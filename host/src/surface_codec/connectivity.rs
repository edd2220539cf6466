//! Connectivity of the base mesh, face by face outwards from the first one of each component.
//!
//! Faces grow over *gates*: sides of faces that are there whose other side is not decided yet, first come, first served.
//! For each gate it is told whether a face lies behind it, of how many sides, and for each further corner of it whether
//! it is the next one along the open sides to the left or to the right, a new vertex, or which other one. Vertices and
//! faces are numbered anew, in the order in which they are met; any number of components, handles and boundaries comes
//! about without a special case. Of the region-growing coders this is the simplest: Gumhold & Straßer, *Real Time
//! Compression of Triangle Mesh Connectivity*, SIGGRAPH 1998.

use std::collections::{HashMap, VecDeque};

use wavelift_kernel::bits::{BitCoder, Chance};

use super::error::EncodeError;
use super::number::{Number, code_plain};
use crate::mesh::Faces;

/// What is known of a mesh that is to be encoded.
#[derive(Debug)]
pub(super) struct Given<'a> {
    faces: &'a Faces,
    /// The face that has a side, and which corner of it the side begins with.
    sides: HashMap<[u32; 2], (u32, u32)>,
    done: Vec<bool>,
    /// Numbers of vertices in the file.
    new_vertices: Vec<Option<u32>>,
    next_seed: usize,
}

/// How the file orders what it was given.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Order {
    /// For each vertex of the file which it was.
    pub(super) vertices: Vec<u32>,
    /// For each face of the file which it was, and which of its corners is the first one now.
    pub(super) faces: Vec<(u32, u32)>,
}

/// Where a vertex was met: what its place is predicted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// At the beginning of a component or after another vertex of its first face.
    After(Option<u32>),
    /// After corner `to` of the gate `from`-`to` before face `behind`; the last corner of a triangle or not.
    Beside { behind: u32, from: u32, to: u32, triangle: bool },
    /// The fourth or a later corner, so that `corner` is to it what `to` is to `from`.
    Across { from: u32, to: u32, corner: u32 },
}

/// What connectivity the file has.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Connectivity {
    pub(super) faces: Faces,
    /// One a vertex.
    pub(super) origins: Vec<Origin>,
}

impl<'a> Given<'a> {
    /// # Errors
    /// [`EncodeError::Side`] if two faces run along a side in the same direction, [`EncodeError::Isolated`] if a vertex has
    /// no face.
    pub(super) fn new(vertices: usize, faces: &'a Faces) -> Result<Self, EncodeError> {
        let mut sides = HashMap::with_capacity(faces.corners().len());
        let mut used = vec![false; vertices];
        for (face, corners) in faces.iter().enumerate() {
            for (side, &from) in corners.iter().enumerate() {
                used[from as usize] = true;
                let to = corners[(side + 1) % corners.len()];
                if sides.insert([from, to], (face as u32, side as u32)).is_some() {
                    return Err(EncodeError::Side { from, to });
                }
            }
        }
        if let Some(vertex) = used.iter().position(|used| !used) {
            return Err(EncodeError::Isolated { vertex });
        }
        let (done, new_vertices) = (vec![false; faces.len()], vec![None; vertices]);
        Ok(Self { faces, sides, done, new_vertices, next_seed: 0 })
    }

    /// The first face of the next component.
    fn seed(&mut self) -> Option<(u32, u32)> {
        self.next_seed += self.done[self.next_seed..].iter().position(|done| !done)?;
        Some((self.next_seed as u32, 0))
    }

    /// The face with a side, given by old vertices.
    fn behind(&self, from: u32, to: u32) -> Option<(u32, u32)> {
        self.sides.get(&[from, to]).copied().filter(|&(face, _)| !self.done[face as usize])
    }
}

/// Chances of everything that is told of connectivity.
struct Models {
    component: Chance,
    face: Chance,
    degree: Number,
    left: [[Chance; 2]; 8],
    right: Chance,
    new: [Chance; 2],
}

/// Sides whose other side is not decided yet, at their ends.
#[derive(Default)]
struct Open {
    ends: Vec<Vec<u32>>,
    starts: Vec<Vec<u32>>,
}

impl Open {
    fn remove(&mut self, from: u32, to: u32) -> bool {
        let Some(place) = self.ends[from as usize].iter().position(|&end| end == to) else { return false };
        self.ends[from as usize].remove(place);
        self.starts[to as usize].retain(|&start| start != from);
        true
    }

    fn add(&mut self, from: u32, to: u32) {
        self.ends[from as usize].push(to);
        self.starts[to as usize].push(from);
    }
}

/// Codes connectivity in either direction.
pub(super) struct Walk<'c, 'g, C> {
    coder: &'c mut C,
    given: Option<Given<'g>>,
    order: Order,
    made: Connectivity,
    vertices: u32,
    limit: [usize; 3],
    open: Open,
    gates: VecDeque<([u32; 2], u32)>,
    /// Faces at each vertex so far.
    around: Vec<u8>,
    models: Models,
}

impl<'c, 'g, C: BitCoder> Walk<'c, 'g, C> {
    /// For a mesh of given numbers of vertices, faces and corners; the mesh itself is given to encode it.
    pub(super) fn new(coder: &'c mut C, given: Option<Given<'g>>, limit: [usize; 3]) -> Self {
        let even = Chance::EVEN;
        Self {
            coder,
            given,
            order: Order::default(),
            made: Connectivity::default(),
            vertices: 0,
            limit,
            open: Open::default(),
            gates: VecDeque::new(),
            around: Vec::new(),
            models: Models {
                component: Chance::expecting(1 << 12, 2),
                face: Chance::expecting(0xF000, 8),
                degree: Number::NEW,
                left: [[even; 2]; 8],
                right: even,
                new: [Chance::expecting(0xE000, 4); 2],
            },
        }
    }

    /// Codes all. `None` if the file says what cannot be, or other numbers than it was said to have.
    pub(super) fn run(mut self) -> Option<(Connectivity, Order)> {
        loop {
            let seed = self.given.as_mut().and_then(Given::seed);
            let more = self.made.faces.is_empty() || {
                let left = self.given.is_some() && seed.is_some();
                self.coder.bit(left, &mut self.models.component)
            };
            if !more {
                break;
            }
            self.face(seed, None)?;
            while let Some(([from, to], behind)) = self.gates.pop_front() {
                if !self.open.ends[from as usize].contains(&to) {
                    continue;
                }
                let next = self.given.as_ref().and_then(|given| {
                    given.behind(self.order.vertices[to as usize], self.order.vertices[from as usize])
                });
                if self.coder.bit(next.is_some(), &mut self.models.face) {
                    self.face(next, Some(([to, from], behind)))?;
                } else {
                    self.open.remove(from, to);
                }
            }
        }
        let numbers = [self.vertices as usize, self.made.faces.len(), self.made.faces.corners().len()];
        (numbers == self.limit).then_some((self.made, self.order))
    }

    /// Codes a face: the one given, if any, turned so that it begins with the side of the gate, if any.
    fn face(&mut self, given: Option<(u32, u32)>, gate: Option<([u32; 2], u32)>) -> Option<()> {
        let old: Vec<u32> = match (&self.given, given) {
            (Some(all), Some((face, first))) => {
                let corners = all.faces.get(face as usize);
                (0..corners.len()).map(|corner| corners[(first as usize + corner) % corners.len()]).collect()
            }
            _ => Vec::new(),
        };
        let degree = 3 + self.models.degree.code(self.coder, (old.len() as u32).saturating_sub(3)) as usize;
        let room = self.limit[2].checked_sub(self.made.faces.corners().len())?;
        if degree > room || self.made.faces.len() >= self.limit[1] {
            return None;
        }
        let mut corners: Vec<u32> = Vec::new();
        corners.extend(gate.iter().flat_map(|(side, _)| side));
        while corners.len() < degree {
            let corner = self.corner(&corners, old.get(corners.len()).copied(), gate, degree)?;
            corners.push(corner);
        }
        self.close(&corners)?;
        if let (Some(all), Some(face)) = (&mut self.given, given) {
            all.done[face.0 as usize] = true;
            self.order.faces.push(face);
        }
        Some(())
    }

    /// Codes the next corner of a face.
    fn corner(
        &mut self,
        before: &[u32],
        old: Option<u32>,
        gate: Option<([u32; 2], u32)>,
        degree: usize,
    ) -> Option<u32> {
        let target =
            old.and_then(|old| self.given.as_ref().and_then(|given| given.new_vertices[old as usize]));
        let is_last = before.len() + 1 == degree;
        if gate.is_some()
            && let Some(&last) = before.last()
        {
            let near = |list: &[u32]| list.iter().rev().copied().find(|vertex| !before.contains(vertex));
            let left = near(&self.open.starts[last as usize]);
            let right = if is_last { near(&self.open.ends[before[0] as usize]) } else { None };
            if let Some(left) = left {
                let around = usize::from(self.around[last as usize]).min(7);
                let chance = &mut self.models.left[around][usize::from(right == Some(left))];
                if self.coder.bit(target == Some(left), chance) {
                    return Some(left);
                }
            }
            if let Some(right) = right.filter(|_| right != left)
                && self.coder.bit(target == Some(right), &mut self.models.right)
            {
                return Some(right);
            }
        }
        if self.coder.bit(target.is_none(), &mut self.models.new[usize::from(gate.is_some())]) {
            return self.new_vertex(before, old, gate, degree);
        }
        let bits = u32::BITS - self.vertices.leading_zeros();
        Some(code_plain(self.coder, target.unwrap_or(0), bits)).filter(|&vertex| vertex < self.vertices)
    }

    fn new_vertex(
        &mut self,
        before: &[u32],
        old: Option<u32>,
        gate: Option<([u32; 2], u32)>,
        degree: usize,
    ) -> Option<u32> {
        let vertex = self.vertices;
        if vertex as usize >= self.limit[0] {
            return None;
        }
        self.vertices += 1;
        self.open.ends.push(Vec::new());
        self.open.starts.push(Vec::new());
        self.around.push(0);
        self.made.origins.push(match (gate, before) {
            (Some(([from, to], behind)), [_, _]) => {
                Origin::Beside { behind, from, to, triangle: degree == 3 }
            }
            (Some(([from, to], _)), [.., corner]) => Origin::Across { from, to, corner: *corner },
            _ => Origin::After(before.last().copied()),
        });
        if let (Some(given), Some(old)) = (&mut self.given, old) {
            given.new_vertices[old as usize] = Some(vertex);
            self.order.vertices.push(old);
        }
        Some(vertex)
    }

    /// Adds a face. `None` if one of its sides is there already in the same direction.
    fn close(&mut self, corners: &[u32]) -> Option<()> {
        let face = self.made.faces.len() as u32;
        for (side, &from) in corners.iter().enumerate() {
            let to = corners[(side + 1) % corners.len()];
            if from == to || self.open.ends[from as usize].contains(&to) {
                return None;
            }
            self.around[from as usize] = self.around[from as usize].saturating_add(1);
            if !self.open.remove(to, from) {
                self.open.add(from, to);
                self.gates.push_back(([from, to], face));
            }
        }
        self.made.faces.push(corners);
        Some(())
    }
}
