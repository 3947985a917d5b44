//! What straight lines are made from, which has to be known before the first of them. In: items, one by one;
//! the machine they are for, the name of their program. Out: where their zero lies; lines that begin `; `.

use machine::{Kinematics, Machine};
use protocol::{Axis, Code, FORMULAS, Item, PerAxis, Position, Shape, Work};
use shape::{Formula, Op};

/// Most lines that say what was traced.
const MOST: usize = 40;

/// What is known of all items together.
#[derive(Default)]
pub(crate) struct About {
    formulas: [Formula; FORMULAS],
    /// What was traced, in words.
    traced: Vec<String>,
    seams: bool,
    /// Machine position of the zero of the first trace.
    pub(super) zero: PerAxis<Position>,
}

impl About {
    /// The next item.
    pub(crate) fn item(&mut self, item: &Item) {
        match &item.code {
            Code::Formula { slot, formula } => {
                if let Some(place) = self.formulas.get_mut(usize::from(*slot)) {
                    *place = *formula;
                }
            }
            Code::Work(trace) => {
                if self.traced.is_empty() {
                    self.zero = zero(trace);
                }
                self.seams |= matches!(trace.shape, Shape::Seam(_));
                let text = work(trace, &self.formulas);
                // The segments of a seam say the same.
                if !self.traced.contains(&text) {
                    self.traced.push(text);
                }
            }
            _ => {}
        }
    }

    /// Whether they follow formulas.
    pub(crate) fn works(&self) -> bool {
        !self.traced.is_empty()
    }

    /// Whether some of that are seams.
    pub(crate) fn seams(&self) -> bool {
        self.seams
    }

    /// What stands above the lines: what they were made from, for which machine, and what they change there.
    /// `program` is the name of the program, without its folder.
    pub(crate) fn header(&self, machine: &Machine, program: &str) -> Vec<String> {
        let mut traced = self.traced.clone();
        if traced.len() > MOST {
            let more = traced.len() - MOST;
            traced.truncate(MOST);
            traced.push(format!("and {more} more"));
        }
        let made = format!("straight lines of {program}, made by pitchlock compile --g1");
        let on = format!("for machine {}; from where its axes rest at home", machine.general.name);
        let zero =
            "overwrites the zero of G54: the line with G10 L2 P1; take it away where G54 is set".to_owned();
        let timed = "each line along a seam has the time it takes (G93)";
        let seam = machine.general.kinematics == Kinematics::Positioner && !traced.is_empty();
        let timed = seam.then(|| timed.to_owned());
        let lines = [made, on].into_iter().chain(traced).chain([zero]).chain(timed);
        lines.flat_map(|line| comments(&line)).collect()
    }
}

/// Machine position of the zero of a trace.
fn zero(trace: &Work) -> PerAxis<Position> {
    let mut zero = PerAxis::default();
    let axes: &[Axis] = match &trace.shape {
        Shape::Seam(_) => &[],
        Shape::Contour(_, axes) => axes,
        Shape::Surface(_) => &[Axis::X, Axis::Y, Axis::Z],
    };
    for (axis, origin) in axes.iter().zip(trace.origin) {
        zero[axis.index()] = origin;
    }
    zero
}

/// A trace in words and figures.
fn work(trace: &Work, formulas: &[Formula; FORMULAS]) -> String {
    let text = |[first, second, third, ..]: &[Formula; FORMULAS], variables| {
        [first, second, third].map(|formula| infix(formula, variables))
    };
    let [first, ..] = text(formulas, ["x", "y"]);
    let what = match &trace.shape {
        Shape::Surface(surface) => {
            let tool = surface.tool;
            let end = match tool.corner_mm {
                corner if corner == tool.radius_mm => "ball".to_owned(),
                0.0 => "flat".to_owned(),
                corner => format!("bull with corners of {corner} mm"),
            };
            format!("surface z = {first}, tool {end} of {} mm", 2.0 * tool.radius_mm)
        }
        Shape::Contour(contour, [master, follower]) => {
            format!("contour {follower} = {first} of {master}, tool radius {} mm", contour.radius_mm)
        }
        Shape::Seam(seam) => match seam.curve {
            shape::SeamCurve::Formulas => {
                let [x, y, z] = text(formulas, ["t", "t"]);
                format!("seam x = {x}, y = {y}, z = {z}")
            }
            shape::SeamCurve::Polynomials(_) => "seam through points".to_owned(),
            shape::SeamCurve::Meeting(_) => "seam where two surfaces meet".to_owned(),
        },
    };
    format!("{what}, chord error {} mm, {} mm/min", trace.chord_mm, trace.feed_mm_min)
}

/// A text as comments; a long one goes on in the next line.
fn comments(text: &str) -> Vec<String> {
    // Controls read lines of 255 characters; a line break in a name would end the comment.
    const LONGEST: usize = 160;
    let text: Vec<char> = text.replace(char::is_control, " ").chars().collect();
    text.chunks(LONGEST).map(|part| format!("; {}", part.iter().collect::<String>())).collect()
}

/// How firmly an expression holds together: sums least.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const SIGN: u8 = 3;
const POWER: u8 = 4;
const WHOLE: u8 = 5;

/// A formula as people write it.
fn infix(formula: &Formula, variables: [&str; 2]) -> String {
    let mut stack: Vec<(String, u8)> = Vec::new();
    for op in formula.ops() {
        // No formula takes more than there is.
        let mut take = |least: u8| {
            let (text, holds) = stack.pop().unwrap_or_default();
            if holds < least { format!("({text})") } else { text }
        };
        let made = match op {
            Op::Constant(value) => (value.to_string(), if value < 0.0 { SIGN } else { WHOLE }),
            Op::Variable(number) => {
                (variables.get(usize::from(number)).copied().unwrap_or_default().to_owned(), WHOLE)
            }
            Op::Add => joined(take(SUM), " + ", take(SUM), SUM),
            Op::Sub => joined(take(PRODUCT), " - ", take(SUM), SUM),
            Op::Mul => joined(take(PRODUCT), "*", take(PRODUCT), PRODUCT),
            Op::Div => joined(take(SIGN), "/", take(PRODUCT), PRODUCT),
            Op::Neg => (format!("-{}", take(POWER)), SIGN),
            Op::Powi(exponent @ ..0) => (format!("{}^({exponent})", take(WHOLE)), POWER),
            Op::Powi(exponent) => (format!("{}^{exponent}", take(WHOLE)), POWER),
            Op::Apply(function) => {
                (format!("{}({})", format!("{function:?}").to_lowercase(), take(SUM)), WHOLE)
            }
        };
        stack.push(made);
    }
    stack.pop().unwrap_or_default().0
}

/// Two expressions around a sign; the second one was taken first.
fn joined(second: String, sign: &str, first: String, holds: u8) -> (String, u8) {
    (first + sign + &second, holds)
}
