//! Division of whole numbers of 64 bits.

/// Quotient and rest, bit by bit: as many turns as the quotient has bits. A divisor of zero gives zero and
/// `number`.
#[must_use]
pub fn divide_u64(number: u64, divisor: u64) -> (u64, u64) {
    let (mut quotient, mut rest) = (0, number);
    if divisor == 0 {
        return (quotient, rest);
    }
    let mut turns = divisor.leading_zeros().wrapping_sub(number.leading_zeros()).wrapping_add(1);
    if turns > u64::BITS {
        return (quotient, rest); // the divisor is the longer one
    }
    let mut shifted = divisor << (turns.wrapping_sub(1) & 63);
    while turns > 0 {
        quotient <<= 1;
        if rest >= shifted {
            rest -= shifted;
            quotient |= 1;
        }
        shifted >>= 1;
        turns -= 1;
    }
    (quotient, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_and_rests_are_the_processor_s() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed ^ seed >> 29) >> (seed >> 58)
        };
        for _ in 0..200_000 {
            let (number, divisor) = (next(), next());
            if divisor > 0 {
                assert_eq!(divide_u64(number, divisor), (number / divisor, number % divisor));
            }
        }
        for number in [0, 1, u64::MAX] {
            assert_eq!(divide_u64(number, 1), (number, 0));
            assert_eq!(divide_u64(number, u64::MAX), (number / u64::MAX, number % u64::MAX));
            assert_eq!(divide_u64(number, 0), (0, number));
        }
    }
}
