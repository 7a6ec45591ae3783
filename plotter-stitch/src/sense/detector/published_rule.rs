//! The published rule: a line lies where the head was in the tact that saw it most.

use super::{FindLine, Optics, Order, ScanError, Sighting, Tact};

/// The three cases of the source.
///
/// ```text
///  7a)  0 h 0   seen in tact k alone                      the head's position in tact k
///  7b)  2 1     twice in tact k, once in tact k+1         in tact k
///  7c)  1 2     once in tact k, twice in tact k+1         in tact k+1
/// ```
///
/// The source says no more. What it leaves open is decided by the same idea, the tact that saw it most: of
/// `1 2 1` the middle one, and of several with as many hits (`2 2`, slower scans) the first.
///
/// A head of 0.3 m/s moves 0.6 mm a tact, so what is found may lie more than 0.3 mm beside the line: a
/// standard deviation of 0.17 mm.
///
/// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section III,
/// figure 7.
///
/// ```
/// use plotter_stitch::{FindLine, Optics, sense::{PublishedRule, Tact}};
///
/// let mut rule = PublishedRule::new(&Optics::default(), 300.0);
/// let tacts = [(9.4, 0), (10.0, 1), (10.6, 2), (11.2, 0)]; // case 7c
/// let mut found = None;
/// for (position_mm, hits) in tacts {
///     found = found.or(rule.push(Tact { position_mm, hits, covered: None })?);
/// }
/// assert_eq!(found.map(|sighting| sighting.at_mm), Some(10.6));
/// # Ok::<(), plotter_stitch::ScanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedRule {
    order: Order,
    tact_mm: f64,
    seen: Option<Seen>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    /// Position of the tact with the most hits, mm.
    at_mm: f64,
    most: u8,
    tacts: u32,
}

impl PublishedRule {
    /// For a scan with that velocity, mm/s; negative towards smaller coordinates.
    #[must_use]
    pub fn new(optics: &Optics, velocity_mm_s: f64) -> Self {
        Self {
            order: Order::new(velocity_mm_s),
            tact_mm: libm::fabs(velocity_mm_s * optics.tact_s),
            seen: None,
        }
    }
}

impl FindLine for PublishedRule {
    fn push(&mut self, tact: Tact) -> Result<Option<Sighting>, ScanError> {
        self.order.check(&tact)?;
        if tact.hits == 0 {
            return Ok(self.finish());
        }
        let seen = self.seen.get_or_insert(Seen { at_mm: tact.position_mm, most: tact.hits, tacts: 0 });
        if tact.hits > seen.most {
            (seen.at_mm, seen.most) = (tact.position_mm, tact.hits);
        }
        seen.tacts = seen.tacts.saturating_add(1);
        Ok(None)
    }

    fn finish(&mut self) -> Option<Sighting> {
        let Seen { at_mm, tacts, .. } = self.seen.take()?;
        Some(Sighting {
            at_mm,
            span_mm: f64::from(tacts) * self.tact_mm,
            // Evenly spread over a tact.
            sigma_mm: self.tact_mm / libm::sqrt(12.0),
            like_a_line: true, // the rule does not ask
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(hits: &[u8]) -> std::vec::Vec<f64> {
        let mut rule = PublishedRule::new(&Optics::default(), 300.0);
        let mut sightings = std::vec::Vec::new();
        for (index, &hits) in (0_u32..).zip(hits) {
            sightings.extend(rule.push(Tact { position_mm: f64::from(index), hits, covered: None }).unwrap());
        }
        sightings.extend(rule.finish());
        sightings.iter().map(|sighting| sighting.at_mm).collect()
    }

    #[test]
    fn the_three_cases_of_the_source() {
        assert_eq!(found(&[0, 2, 0]), [1.0], "7a");
        assert_eq!(found(&[0, 1, 0]), [1.0], "7a");
        assert_eq!(found(&[0, 2, 1, 0]), [1.0], "7b");
        assert_eq!(found(&[0, 1, 2, 0]), [2.0], "7c");
    }

    #[test]
    fn what_the_source_leaves_open_is_the_tact_that_saw_most() {
        assert_eq!(found(&[0, 1, 2, 1, 0]), [2.0]);
        assert_eq!(found(&[0, 2, 2, 0]), [1.0]);
        assert_eq!(found(&[1, 1]), [0.0]);
        assert_eq!(found(&[2, 0, 1]), [0.0, 2.0]);
        assert_eq!(found(&[0, 0]), [0.0; 0]);
    }
}
