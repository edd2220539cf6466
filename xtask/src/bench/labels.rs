//! Where the labels of points go, so that none covers another, a point, or the edge.

/// A rectangle in pixels: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rect {
    /// A square round a point.
    pub(super) fn round((x, y): (f64, f64), radius: f64) -> Self {
        Self { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }
    }

    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn lies_in(&self, area: &Self) -> bool {
        self.left >= area.left
            && self.top >= area.top
            && self.right <= area.right
            && self.bottom <= area.bottom
    }

    /// The place nearest to a point.
    pub(super) fn nearest(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x.clamp(self.left, self.right), y.clamp(self.top, self.bottom))
    }
}

/// Directions from a point to its label, best first.
const DIRECTIONS: [(f64, f64); 12] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
    (1.0, -1.0),
    (1.0, 1.0),
    (-1.0, -1.0),
    (-1.0, 1.0),
    (0.5, -1.0),
    (0.5, 1.0),
    (-0.5, -1.0),
    (-0.5, 1.0),
];

/// From the point to the nearest edge of its label, in pixels: tried in turn.
const DISTANCES: [f64; 8] = [9.0, 13.0, 18.0, 25.0, 34.0, 46.0, 60.0, 80.0];

/// Half of the side of the square that a point keeps free of labels.
const POINT: f64 = 7.0;

/// The same for a place that labels shall keep off.
const OBSTACLE: f64 = 3.0;

/// A place for a label of each size beside each point, in `area`, off `obstacles`; earlier ones choose first. Labels
/// that find no free place lie to the right of their points, whatever they cover.
pub(super) fn place(
    points: &[(f64, f64)],
    sizes: &[(f64, f64)],
    obstacles: &[(f64, f64)],
    area: &Rect,
) -> Vec<Rect> {
    let mut taken: Vec<Rect> = points.iter().map(|&point| Rect::round(point, POINT)).collect();
    taken.extend(obstacles.iter().map(|&point| Rect::round(point, OBSTACLE)));
    let mut places = vec![];
    for (&point, &size) in points.iter().zip(sizes) {
        let tried =
            DISTANCES.iter().flat_map(|&distance| DIRECTIONS.map(|to| beside(point, size, to, distance)));
        let free = |place: &Rect| place.lies_in(area) && taken.iter().all(|other| !place.meets(other));
        let chosen =
            tried.into_iter().find(free).unwrap_or_else(|| beside(point, size, (1.0, 0.0), DISTANCES[0]));
        taken.push(chosen);
        places.push(chosen);
    }
    places
}

/// The rectangle of a size whose edge is a distance from a point, in a direction.
fn beside((x, y): (f64, f64), (width, height): (f64, f64), (right, down): (f64, f64), distance: f64) -> Rect {
    let left = x - width / 2.0 + right * (width / 2.0 + distance);
    let top = y - height / 2.0 + down * (height / 2.0 + distance);
    Rect { left, top, right: left + width, bottom: top + height }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rect = Rect { left: 0.0, top: 0.0, right: 600.0, bottom: 400.0 };

    #[test]
    fn labels_cover_neither_each_other_nor_points_nor_edges() {
        let points: Vec<(f64, f64)> =
            (0..20).map(|i| (f64::from(i * 37 % 120) + 300.0, f64::from(i * 53 % 90) + 150.0)).collect();
        let places = place(&points, &[(70.0, 14.0); 20], &[], &AREA);
        for (index, label) in places.iter().enumerate() {
            assert!(label.lies_in(&AREA), "{label:?}");
            assert!(places[..index].iter().all(|other| !label.meets(other)), "{label:?}");
            assert!(points.iter().all(|&point| !label.meets(&Rect::round(point, POINT))), "{label:?}");
        }
    }

    #[test]
    fn a_label_is_to_the_right_unless_an_obstacle_or_the_edge_is_there() {
        let label = |x: f64| place(&[(x, 200.0)], &[(50.0, 14.0)], &[(300.0, 200.0)], &AREA)[0];
        assert_eq!(label(100.0), Rect { left: 109.0, top: 193.0, right: 159.0, bottom: 207.0 });
        assert_eq!(label(270.0).right, 261.0);
        assert_eq!(label(590.0), Rect { left: 531.0, top: 193.0, right: 581.0, bottom: 207.0 });
    }
}
