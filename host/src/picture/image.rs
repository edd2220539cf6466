//! A picture as pixels.

/// Rows of pixels from the top, three bytes each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pixels along x and y.
    pub size: [u32; 2],
    /// Red, green and blue of each pixel, row by row from the top.
    pub pixels: Vec<u8>,
}

impl Image {
    /// Red, green and blue of the pixel at x, y from the upper left.
    ///
    /// # Panics
    /// If it lies outside.
    pub fn pixel(&self, [x, y]: [u32; 2]) -> [u8; 3] {
        assert!(x < self.size[0] && y < self.size[1], "a pixel of the picture");
        let place = 3 * (y as usize * self.size[0] as usize + x as usize);
        [self.pixels[place], self.pixels[place + 1], self.pixels[place + 2]]
    }
}
