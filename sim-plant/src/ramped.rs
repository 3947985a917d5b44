//! A quantity that goes to a new value in a straight line: an override knob being turned, a cutting force
//! coming on. In: target and a number of control cycles. Out: the value in each cycle.

/// A value on its way to a target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramped {
    value: f64,
    target: f64,
    step: f64,
}

impl Ramped {
    /// At rest at a value.
    pub(crate) fn at(value: f64) -> Ramped {
        Ramped { value, target: value, step: 0.0 }
    }

    /// Goes from the present value to a target within `cycles`; at once for fewer than one.
    pub(crate) fn go(&mut self, target: f64, cycles: f64) {
        self.target = target;
        self.step = (target - self.value).abs() / cycles.max(1.0);
        if cycles < 1.0 {
            self.value = target;
        }
    }

    /// One control cycle.
    pub(crate) fn advance(&mut self) {
        let left = self.target - self.value;
        // The last step lands on the target itself, whatever the rounding of the steps before.
        self.value = if left.abs() <= self.step * (1.0 + 1e-9) {
            self.target
        } else {
            self.value + self.step.copysign(left)
        };
    }

    pub(crate) fn value(&self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::Ramped;

    #[test]
    fn arrives_exactly_and_on_time() {
        let mut knob = Ramped::at(100.0);
        knob.go(60.0, 7.0);
        let path: Vec<f64> = (0..9)
            .map(|_| {
                knob.advance();
                knob.value()
            })
            .collect();
        assert!((path[0] - (100.0 - 40.0 / 7.0)).abs() < 1e-12 && path[5] > 60.0);
        assert_eq!(path[6..], [60.0, 60.0, 60.0]);
    }

    #[test]
    fn no_cycles_means_at_once() {
        let mut knob = Ramped::at(100.0);
        knob.go(80.0, 0.0);
        assert_eq!(knob.value(), 80.0);
    }
}
