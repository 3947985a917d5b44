//! The linear scale at the slide.
//! In: true position of the slide, mm. Out: what the scale shows, the middle of one of its steps.

use protocol::Position;

/// A scale with steps of a certain length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    step_mm: f64,
    /// Where the zero of the machine lies within its step, a share of one.
    phase: f64,
}

impl Scale {
    pub(crate) fn new(step_mm: f64, phase: f64) -> Scale {
        Scale { step_mm, phase }
    }

    pub(crate) fn position(&self, slide_mm: f64) -> Position {
        let step = (slide_mm / self.step_mm + self.phase).floor();
        Position::from_mm((step + 0.5 - self.phase) * self.step_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn shows_the_middle_of_the_step_that_the_slide_is_in() {
        let scale = Scale::new(1e-3, 0.25);
        for (slide_mm, shown_mm) in
            [(0.0, 0.00025), (0.0007, 0.00025), (0.0008, 0.00125), (-0.0003, -0.00075), (12.0, 12.00025)]
        {
            assert!((scale.position(slide_mm).mm() - shown_mm).abs() < 1e-9, "at {slide_mm}");
        }
    }
}
