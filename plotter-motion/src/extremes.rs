//! The greater and the smaller of two numbers. On a small processor, which has no `f64`, each is 60 bytes wherever it stands, and
//! 16 where it is called.

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
