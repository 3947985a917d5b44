//! The words of the page. In: rows where a sentence says a figure. Out: paragraphs and captions.

use super::{Compared, Row, um};

/// The result in a few sentences.
pub(super) fn short(rows: &[Row]) -> Vec<String> {
    let figures = || rows.iter().flat_map(|row| &row.figures);
    let (all, agree) = (figures().count(), figures().filter(|figure| figure.agrees()).count());
    let large = || figures().filter(|figure| figure.reference().abs() >= 1.95);
    let share = |figure: &Compared| (figure.median / figure.reference() - 1.0).abs();
    let within = large().filter(|figure| share(figure) <= super::SHARE).count();
    let small = figures().filter(|figure| figure.reference().abs() < 1.95);
    let most = small.map(|figure| (figure.median - figure.reference()).abs()).fold(0.0, f64::max);
    vec![
        format!(
            "{agree} of {all} figures of the reference simulation come out within 5 %, one of their last digit, or what \
             eight seeds spread over. Of those of 2 µm and more {within} of {} come out within 5 %; those below \
             2 µm within {} µm.",
            large().count(),
            um(most)
        ),
        "What it takes beyond what is printed there: bristles with a damping ratio of 0.1, and the thread from a tenth of \
         a turn behind the approach."
            .into(),
    ]
}

/// What was done.
pub(super) fn done() -> Vec<String> {
    let paragraphs = [
        "A reference simulation of one servo axis was written before this machine, as a program of its own: a motor of \
         1 kW on a screw of 5 mm, a slide of 110 kg on a mode of 100 Hz, friction with bristles at both, a current lag \
         and a cycle of delay of 0.5 ms each, a velocity loop at 2 kHz. It printed servo errors of X for nine \
         structures of feedforward at three overrides of the spindle, in a pass of 5 mm in one turn at 300 1/min.",
        "Here the whole machine runs that pass, with the plant, the loops and the encoders that were printed, whatever \
         the machine file says; the controller knows masses and friction as they are. The angle is observed once in \
         1 ms, as there (on this machine otherwise in every control cycle), and the structures with held references \
         move on once in 1 ms. The raw angle is an observer without any filter.",
        "Servo error: reference at the observed angle minus measurement of the same instant. Each figure is the median \
         of eight seeds, which put encoders and spindle elsewhere at the start.",
    ];
    paragraphs.into_iter().map(str::to_owned).collect()
}

/// What it means.
pub(super) fn meaning() -> Vec<(&'static str, Vec<String>)> {
    vec![
        (
            "What was identified",
            vec![
                "The reference does not print how its bristles are damped. It prints how far the slide of X is off 1.35 s \
                 into the thread, when its friction has let go of part of the wind-up: 1.55 µm, and 1.10 µm without the \
                 damping. A damping ratio of 0.1 of each mass on its bristles gives 1.6 µm here (1.59 µm over 64 seeds); 0.3 gives 1.9 µm."
                    .into(),
                "Nor does it say where its thread begins. From a tenth of a turn behind the stroke on, errors come out as \
                 printed at all three overrides, for structures whose error dies away within 0.1 s."
                    .into(),
            ],
        ),
        (
            "What it means",
            vec![
                "With the same switches on, this plant does to a servo axis what that of the reference did: figures that are \
                 measured on it are no easier to come by. The built-in machine has a screw without breakaway, bristles \
                 without damping and an observer that looks twice as often: the table of steps says what each of them \
                 is worth."
                    .into(),
                "Creep is made by the noise of the loops, which lets the bristles of the guide slip a little in every \
                 swing. Without damping the slide has crept less here than in the reference, by 6 to 12 % of what it \
                 is still off: the noise is another one."
                    .into(),
                "Where the controller feeds forward everything, what is left in the approach is the count of the encoder: \
                 1024 lines are 2.4 µm of X where it moves fastest. Those figures hang on where its counts fall, and \
                 spread over several tenths of a micrometre from seed to seed; the printed ones are those of one. \
                 With tight loops and 2500 lines at 60 % it lies near the edge: medians here are ±0.6 µm where ±1.0 µm \
                 is printed, and of 64 seeds the worst come to -0.95 and 0.97 µm."
                    .into(),
            ],
        ),
    ]
}

pub(super) fn rows() -> String {
    "Median of eight seeds. End: the first sample after the stroke. Thread: from a tenth of a turn later on, largest \
     magnitude. Apart: figures that agree neither within 5 %, nor within one of their last digit, nor within what the \
     seeds spread over."
        .into()
}

pub(super) fn steps() -> String {
    "The same structure with more and more of what the reference has. Slide: commanded minus true slide."
        .into()
}

pub(super) fn spread() -> String {
    "Least and most of eight seeds.".into()
}
