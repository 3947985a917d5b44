//! Formulas, surfaces, seams and the positioner against closed forms, random cases and reference values.

mod compressor;
mod number;
mod offset;
mod piece;
mod poles;
mod positioner;
mod reference;
mod seam;
mod shaping;
