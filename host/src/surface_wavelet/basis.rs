//! The lifts that make up each wavelet.

/// Which vertices a lift moves, and from which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Old vertices and those in edges, from those in faces: the s-lift of Diss eq. (4.12).
    S,
    /// Vertices in faces and in edges, from the old ones: the w-lift of Diss eq. (4.13).
    W,
}

/// `edge <- b edge + 2a centre average`, then `corner <- b² corner - 4a² centre average + 4a edge average`, where corners
/// are old vertices and centres those in faces for an s-lift, and the other way round for a w-lift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lift {
    /// What is moved.
    pub kind: Kind,
    /// Weight of the neighbours.
    pub a: f64,
    /// Weight of what is moved.
    pub b: f64,
}

const fn s(a: f64, b: f64) -> Lift {
    Lift { kind: Kind::S, a, b }
}

const fn w(a: f64, b: f64) -> Lift {
    Lift { kind: Kind::W, a, b }
}

/// B-splines that the surfaces and wavelets of a transform are made of, where the mesh is regular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Flat between control points: Diss eq. (4.15).
    Bilinear,
    /// Vis2000 eq. (3.8), Diss eq. (4.22).
    Bicubic,
    /// Diss eq. (4.7), scaled so that old vertices are points after every lift, which sharp vertices need, as Diss §4.1.3
    /// does it for the bicubic one; details of edges come out 3/2 and those of faces 9/4 of what (4.7) gives.
    Biquintic,
}

impl Basis {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Bilinear, Self::Bicubic, Self::Biquintic];

    /// A word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bilinear => "bilinear",
            Self::Bicubic => "bicubic",
            Self::Biquintic => "biquintic",
        }
    }

    /// The lifts of reconstruction, in order; decomposition undoes them from last to first.
    pub const fn lifts(self) -> &'static [Lift] {
        match self {
            Self::Bilinear => const { &[s(-0.25, 1.0), w(0.5, 1.0)] },
            Self::Bicubic => const { &[s(-0.375, 1.0), w(0.5, 1.0), s(0.25, 0.5)] },
            Self::Biquintic => {
                const { &[s(-5.0 / 12.0, 1.0), w(0.5, 1.0), s(0.375, 0.25), w(1.0 / 6.0, 2.0 / 3.0)] }
            }
        }
    }
}
