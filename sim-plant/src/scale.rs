//! The linear scale at the slide. In: true position of the slide, mm. Out: what the scale shows, the middle
//! of one of its steps.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | y, q | mm | slide, and step of the scale |
//! | y0, q0 | mm | where the controller took the slide to be at home, and what it takes for the step |
//! | h | mm | where the slide truly was then |
//!
//! ```text
//! step = floor((y − h + y0)/q + phase),   shown = (step + ½ − phase) q0 + y0 (1 − q0/q)               (M116)
//! ```

use protocol::Position;

/// A scale with steps of a certain length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    step_mm: f64,
    /// The step that it is taken to have.
    shown_step_mm: f64,
    /// By how much home lies beyond where it is taken to be, and what a wrong step makes of its position.
    home_off_mm: f64,
    datum_mm: f64,
    /// Where the zero of the machine lies within its step, a share of one.
    phase: f64,
}

impl Scale {
    /// A scale whose true and believed step and home are these, each the true one first.
    pub(crate) fn new(steps_mm: [f64; 2], homes_mm: [f64; 2], phase: f64) -> Scale {
        let [step_mm, shown_step_mm] = steps_mm;
        let [home_mm, shown_home_mm] = homes_mm;
        Scale {
            step_mm,
            shown_step_mm,
            home_off_mm: home_mm - shown_home_mm,
            datum_mm: shown_home_mm * (1.0 - shown_step_mm / step_mm),
            phase,
        }
    }

    pub(crate) fn position(&self, slide_mm: f64) -> Position {
        let step = ((slide_mm - self.home_off_mm) / self.step_mm + self.phase).floor();
        Position::from_mm((step + 0.5 - self.phase) * self.shown_step_mm + self.datum_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn shows_the_middle_of_the_step_that_the_slide_is_in() {
        let scale = Scale::new([1e-3; 2], [12.0; 2], 0.25);
        for (slide_mm, shown_mm) in
            [(0.0, 0.00025), (0.0007, 0.00025), (0.0008, 0.00125), (-0.0003, -0.00075), (12.0, 12.00025)]
        {
            assert!((scale.position(slide_mm).mm() - shown_mm).abs() < 1e-9, "at {slide_mm}");
        }
    }

    #[test]
    fn a_wrong_step_counts_from_home_and_a_wrong_home_is_an_offset() {
        // At home it shows what it is taken to be; 10 mm on, 1 % of them too much.
        let scale = Scale::new([1e-3, 1.01e-3], [50.2, 50.0], 0.0);
        for (slide_mm, shown_mm) in [(50.2, 50.0), (60.2, 60.1), (40.2, 39.9)] {
            assert!((scale.position(slide_mm).mm() - shown_mm).abs() < 2e-3, "at {slide_mm}");
        }
    }
}
