//! Inputs that ask for much memory, made on purpose.

use super::{JOB_MEMORY, targets};

/// The name of the program says that it is half a gigabyte long.
#[test]
fn the_length_of_a_name_is_no_promise_that_memory_is_taken_for() {
    let mut content = vec![252];
    content.extend((1u32 << 29).to_le_bytes());
    content.extend(b"mutated.ngc");
    let memory = allocation_counter::measure(|| targets::code_file(&content));
    assert!(memory.bytes_max < 10_000, "{} bytes", memory.bytes_max);
}

/// A small tool on a large surface: more places than are looked at, and more of its path than are kept.
#[test]
fn a_job_of_very_many_places_takes_no_more_memory_than_the_page_says() {
    let job = "[job]\nkind = \"surface\"\norigin_mm = [-50, -40, -170]\nz = \"x/50\"\nx = [0, 100]\ny = [0, 80]\n\
               tool = { kind = \"ball\", diameter_mm = 0.4 }\n\
               path = { pattern = \"lines\", along = \"x\", step_mm = 0.1 }\nfeed_mm_min = 1000\n";
    let memory = allocation_counter::measure(|| targets::job(job.as_bytes()));
    assert!((40 << 20..JOB_MEMORY).contains(&memory.bytes_max), "{} bytes", memory.bytes_max);
}
