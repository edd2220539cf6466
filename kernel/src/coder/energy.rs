//! How large ranks are expected to be: a weighted sum of those around them.

/// Sets each of `energies` to what `of` makes of the ranks of known rows around its place: with s = `north` + `up`,
/// s(x-1) + 2 s(x) + s(x+1) and that of `south`, which wrap. Beyond its ends a row has its first and its last rank again.
///
/// Nothing changes if there are no such rows.
#[inline(always)]
pub(super) fn around([north, up, south]: [&[i32]; 3], energies: &mut [i32], of: impl Fn(i32) -> i32) {
    let (Some((north, norths)), Some((up, ups))) = (north.split_first(), up.split_first()) else { return };
    let mut here = north.wrapping_add(*up);
    let mut with_west = here.wrapping_mul(2);
    for (((energy, south), north), up) in energies.iter_mut().zip(south).zip(norths).zip(ups) {
        let east = north.wrapping_add(*up);
        let with_east = here.wrapping_add(east);
        *energy = of(with_west.wrapping_add(with_east).wrapping_add(*south));
        (here, with_west) = (east, with_east);
    }
    if let (Some(energy), Some(south)) = (energies.last_mut(), south.last()) {
        *energy = of(with_west.wrapping_add(here.wrapping_mul(2)).wrapping_add(*south));
    }
}
