//! Colors of faces.

/// Red, green and blue, as screens have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub [u8; 3]);

impl Color {
    /// Darker by a factor from 0 to 1.
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self(self.0.map(|channel| (f64::from(channel) * factor).round() as u8))
    }
}

/// A color for a patch: neighbours in number are far apart in hue, by the golden section of the circle of hues.
pub fn patch_color(patch: u32) -> Color {
    const GOLDEN: u32 = 0x9E37_79B9;
    let hue = f64::from(patch.wrapping_mul(GOLDEN)) / 4_294_967_296.0 * 6.0;
    // Patches a whole circle apart differ in saturation.
    let grey = [0.25, 0.45, 0.35, 0.55][(patch / 7 % 4) as usize];
    let channel = |shift: f64| {
        let place = (hue + shift) % 6.0;
        let pure = ((place - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        (255.0 * (grey + (1.0 - grey) * pure)).round() as u8
    };
    Color([channel(0.0), channel(4.0), channel(2.0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_that_follow_each_other_differ() {
        for patch in 0..100 {
            let [a, b] = [patch_color(patch), patch_color(patch + 1)].map(|color| color.0.map(i32::from));
            let difference: i32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
            assert!(difference > 60, "{patch}: {a:?} {b:?}");
        }
        assert_eq!(patch_color(0), Color([255, 64, 64]));
    }
}
