//! The greater and the smaller of two numbers. On a small processor, which has no `f64`, each is 60 bytes
//! wherever it stands, and 16 where it is called.

/// [`f64::max`].
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    a.max(b)
}

/// [`f64::min`].
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    a.min(b)
}

/// The smaller of two numbers that are none of them NaN: in hardware, where `f32::min` is a call.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two numbers that are none of them NaN.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
