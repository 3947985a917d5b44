//! What only the whole machine can show, measured at its true motion: threads, surfaces, seams, faults,
//! times.

#[path = "../../benches/peer/mod.rs"]
mod peer;
#[path = "../shop/mod.rs"]
mod shop;
mod stand;

mod approach;
mod axis_faults;
mod behind_the_motor;
mod beliefs;
mod cutting;
mod encoder;
mod learning;
mod machine_code;
mod monotone;
mod part;
mod pass_rules;
mod rest_to_rest;
mod seams;
mod soak;
mod surfaces;
mod ten_seeds;
mod thread_quality;
mod timing;
