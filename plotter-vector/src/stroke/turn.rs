//! Turn of a line at a vertex, as the cosine of the angle between the directions before and after it.

/// A sharper turn is a corner: cos 25°. The least angle of a set square is 30°, and a direction that six
/// places tell, which are known to half a pixel, is off by up to 5°.
pub(crate) const CORNER_COS: f64 = 0.906_307_8;

/// Two lines that meet go on in each other where they turn by less: cos 50°, half a right angle and the same
/// 5°.
pub(crate) const GOES_ON_COS: f64 = 0.642_787_6;
