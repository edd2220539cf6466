//! Boxes of samples that are moved from one order of axes to another.

/// Samples along z, y, x and component of a box.
pub(super) type Counts = [usize; 4];

/// Samples from one to the next along z, y, x and component.
pub(super) type Strides = [usize; 4];

/// Copies a box of samples of `size` bytes from the start of `from` to that of `to`.
///
/// One pass over the box; runs that lie together in both are copied whole.
pub(super) fn copy(
    (from, from_strides): (&[u8], Strides),
    (to, to_strides): (&mut [u8], Strides),
    counts: Counts,
    size: usize,
) {
    match size {
        1 => copy_each::<1>(from, from_strides, to, to_strides, counts),
        2 => copy_each::<2>(from, from_strides, to, to_strides, counts),
        4 => copy_each::<4>(from, from_strides, to, to_strides, counts),
        _ => copy_each::<8>(from, from_strides, to, to_strides, counts),
    }
}

fn copy_each<const BYTES: usize>(
    from: &[u8],
    from_strides: Strides,
    to: &mut [u8],
    to_strides: Strides,
    counts: Counts,
) {
    let (from, to) = (from.as_chunks::<BYTES>().0, to.as_chunks_mut::<BYTES>().0);
    let [depth, height, width, components] = counts;
    let is_run = |strides: Strides| (components == 1 || strides[3] == 1) && strides[2] == components;
    let is_run = is_run(from_strides) && is_run(to_strides);
    for z in 0..depth {
        for y in 0..height {
            let from = &from[z * from_strides[0] + y * from_strides[1]..];
            let to = &mut to[z * to_strides[0] + y * to_strides[1]..];
            if is_run {
                to[..width * components].copy_from_slice(&from[..width * components]);
                continue;
            }
            for x in 0..width {
                for component in 0..components {
                    to[x * to_strides[2] + component * to_strides[3]] =
                        from[x * from_strides[2] + component * from_strides[3]];
                }
            }
        }
    }
}

/// Strides of samples whose components lie together, then x, y, z.
pub(super) const fn canonical(counts: Counts) -> Strides {
    let [_, height, width, components] = counts;
    [height * width * components, width * components, components, 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_keep_their_places() {
        let counts = [2, 3, 4, 2];
        let planar: Strides = [12, 4, 1, 24];
        for size in [1, 2, 4, 8] {
            let from: Vec<u8> = (0..48 * size).map(|n| n as u8).collect();
            let (mut to, mut back) = (vec![0; from.len()], vec![0; from.len()]);
            copy((&from, canonical(counts)), (&mut to, planar), counts, size);
            assert_ne!(from, to);
            // Component 1 of the sample at x = 2, y = 1, z = 1.
            let (at, place) = (((3 + 1) * 4 + 2) * 2 + 1, 24 + 12 + 4 + 2);
            assert_eq!(from[at * size..][..size], to[place * size..][..size]);
            copy((&to, planar), (&mut back, canonical(counts)), counts, size);
            assert_eq!(from, back);
            copy((&from, canonical(counts)), (&mut to, canonical(counts)), counts, size);
            assert_eq!(from, to);
        }
    }
}
