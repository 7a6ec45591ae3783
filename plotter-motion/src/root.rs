//! Square roots in `f32`. `libm`'s and its table take half a kilobyte of a microcontroller's flash, this a
//! tenth of it and no more time.

/// The square root of a number not below 0: right to the last bit but one, and of squares of small whole
/// numbers exactly, from 2⁻¹²⁶ on. Below, where an `f32` has fewer bits, it is less right.
///
/// Heron's method. The bits of a float are nearly its logarithm, and half of that is the logarithm of the
/// root: right to a 28th.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn root(square: f32) -> f32 {
    /// Half of the exponent's offset, less what makes the error as great below as above.
    const OFFSET: u32 = 0x1fbd_1df5;
    if !(square > 0.0 && square < f32::INFINITY) {
        return square;
    }
    let mut root = f32::from_bits((square.to_bits() >> 1) + OFFSET);
    for _ in 0..3 {
        root = 0.5 * (root + square / root);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_right_to_the_last_bit_but_one() {
        let all = (0x0080_0000..f32::INFINITY.to_bits()).step_by(997);
        for square in all.map(f32::from_bits) {
            let off = root(square).to_bits().abs_diff(libm::sqrtf(square).to_bits());
            assert!(off <= 1, "{square:e}: {off}");
        }
    }

    #[test]
    fn squares_have_their_root() {
        for number in 1..4096_u16 {
            let number = f32::from(number);
            for scale in [1.0, 0.125, 1024.0] {
                assert_eq!(root(number * number * scale * scale), number * scale);
            }
        }
        assert_eq!([0.0, f32::INFINITY].map(root), [0.0, f32::INFINITY]);
        assert!(root(f32::NAN).is_nan());
    }
}
