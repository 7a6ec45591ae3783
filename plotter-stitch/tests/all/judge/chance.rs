//! The judge's own random numbers.

/// PCG-XSH-RR 64/32 (M. E. O'Neill, 2014), and normal numbers by Box and Muller.
#[derive(Clone, Debug)]
pub struct Chance {
    state: u64,
    spare: Option<f64>,
}

impl Chance {
    pub fn new(seed: u64) -> Self {
        let mut chance = Self { state: seed.wrapping_mul(0xD134_2543_DE82_EF95) ^ 0x5851_F42D, spare: None };
        for _ in 0..4 {
            chance.bits();
        }
        chance
    }

    /// Another row of numbers.
    pub fn split(&mut self) -> Self {
        Self::new(u64::from(self.bits()) << 32 | u64::from(self.bits()))
    }

    #[allow(clippy::cast_possible_truncation, reason = "the lower half is what is wanted")]
    fn bits(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = ((((old >> 18) ^ old) >> 27) & u64::from(u32::MAX)) as u32;
        mixed.rotate_right((old >> 59) as u32)
    }

    /// Evenly spread, above 0 and below 1.
    pub fn unit(&mut self) -> f64 {
        (f64::from(self.bits()) + 0.5) / 4_294_967_296.0
    }

    /// Normal, of deviation 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * self.unit().ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }
}
