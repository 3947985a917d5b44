//! A thread cut in steel: what it costs, and that it stays on its helix. The figures are those of
//! docs/cutting.md.

use crate::shop::{Place, example, project};
use protocol::Axis;
use rig::observe::{CuttingReport, Outcome, PassReport, Summary};

/// The plain lathe with steel in the chuck.
fn steel(place: &Place) -> String {
    let lathe =
        std::fs::read_to_string(project().join("examples/machines/plain-lathe.toml")).expect("shipped");
    let cutting = lathe.replace("specific_force_n_mm2 = 0.0", "specific_force_n_mm2 = 2000.0");
    assert_ne!(cutting, lathe, "the key stands in the file");
    place.write("steel.toml", cutting).display().to_string()
}

fn run(place: &Place, out: &str, more: &[&str]) -> Summary {
    place.run(&example("m20x2"), out, &[&["--trace", "none"], more].concat())
}

/// What docs/cutting.md must say; lines are joined.
fn page_says(words: &str) {
    let page = std::fs::read_to_string(project().join("docs/cutting.md")).expect("the page is there");
    let joined = page.replace("\n  ", " ");
    assert!(joined.contains(words), "docs/cutting.md lacks this:\n{words}");
}

fn cutting(pass: &PassReport) -> CuttingReport {
    pass.cutting.unwrap_or_default()
}

#[test]
fn m20x2_in_steel_slows_the_spindle_and_stays_on_its_helix() {
    let place = Place::new();
    let machine = steel(&place);
    let air = place.run_plain(&example("m20x2"), None);
    let steel = run(&place, "steel", &["--in-process", "--machine", &machine]);
    assert_eq!(steel.outcome, Outcome::Completed, "{:?}", steel.faults);
    assert!(air.passes.iter().all(|pass| pass.cutting.is_none()), "the shipped machine cuts air");

    let first = cutting(&steel.passes[0]);
    let area = 0.42f64.powi(2) * libm::tan(30f64.to_radians());
    assert!((first.chip_area_max_mm2 / area - 1.0).abs() < 0.03, "{first:?} of {area} mm²");
    assert!((first.force_max_n / (3000.0 * first.chip_area_max_mm2) - 1.0).abs() < 1e-9, "{first:?}");

    for (steel, air) in steel.passes.iter().zip(&air.passes) {
        assert!(steel.complete && steel.same_index, "{steel:#?}");
        assert!(steel.tool.helix_max_abs_um <= 2.0, "{steel:#?}");
        assert!(steel.lead_error_um_per_rev.abs() <= 0.1, "{steel:#?}");
        let slower = air.rpm_min - steel.rpm_min;
        assert_eq!(slower > 2.0, cutting(steel).torque_max_nm > 1.0, "{slower} 1/min: {steel:#?}");
    }
    assert!(steel.thread.phase_spread_um <= 1.5, "{} µm", steel.thread.phase_spread_um);
    let off = |pass: &PassReport| pass.tool.helix_max_abs_um;
    let worst = |passes: &[PassReport]| passes.iter().map(off).fold(0.0, f64::max);
    let (with, without) = (worst(&steel.passes), worst(&air.passes));
    page_says(&format!("{with:.2} µm from the helix at most, {without:.2} µm without force"));
}

/// R2 keeps the chip area; the last cut takes what is left to K, the two passes after it are spring passes.
#[test]
fn equal_areas_take_equal_forces_and_spring_passes_next_to_nothing() {
    let place = Place::new();
    let machine = steel(&place);
    let arguments = ["--in-process", "--trace", "mcap", "--machine", &machine];
    let summary = place.run(&example("m20x2"), "steel", &arguments);
    // The force of each pass in the middle of its thread.
    let mut forces = vec![0.0; summary.passes.len() + 1];
    rig::trace::read(&place.at("steel/trace.mcap"), |row| {
        if row.axis(Axis::Z).is_some_and(|z| (z.slide + 10.0).abs() < 0.006) {
            forces[row.pass as usize] = row.cut.force;
        }
    })
    .expect("the trace can be read");
    let [timed, first, cuts @ .., last, spring, again] = &forces[..] else { panic!("{forces:?}") };
    assert_eq!(*timed, 0.0, "only passes cut");
    assert!(*first > 200.0 && cuts.len() == 11, "{forces:?}");
    assert!(cuts.iter().all(|force| (force / first - 1.0).abs() < 0.02), "{forces:?}");
    let (least, most) = cuts.iter().fold((f64::MAX, 0.0f64), |(a, b), force| (a.min(*force), b.max(*force)));
    page_says(&format!("{first:.0} N in the first, {least:.0} to {most:.0} N in the next eleven"));
    page_says(&format!("takes what is left, {spring:.0} N in the thread"));
    // 1 N is what a slide cuts that comes back 0.2 µm deeper: where a groove is that wide, slides repeat no
    // better.
    page_says(&format!("the second {again:.0} N there"));
    assert!(last < &(0.6 * first) && spring < &(0.03 * first) && again < &(0.005 * first), "{forces:?}");
}

#[test]
fn a_second_start_cuts_its_own_groove_and_a_bore_is_cut_outwards() {
    let place = Place::new();
    let machine = steel(&place);
    let cycle = "G76 P4 Z-20 I-2 J0.7 K1.6 R2 Q29.5\n";
    let text = format!("G18 G21 G90 G7\nM3 S400\nG0 X22 Z12\n{cycle}G0 X22 Z10\n{cycle}G0 X40\nM5\nM2\n");
    let two_starts = place.write("two-starts.ngc", text);
    let arguments = ["--in-process", "--trace", "none", "--machine", &machine];
    let summary = place.run(&two_starts, "two-starts", &arguments);
    let of_start = |start| summary.passes.iter().filter(move |pass| pass.start == start);
    assert_eq!(of_start(0).count(), of_start(1).count());
    for (first, second) in of_start(0).zip(of_start(1)) {
        let share = cutting(second).force_max_n / cutting(first).force_max_n;
        assert!((share - 1.0).abs() < 0.05, "pass {}: {share} of that of the first start", second.pass);
    }

    let summary = place.run(&example("internal-m30"), "bore", &arguments);
    for pass in &summary.passes {
        assert!(cutting(pass).force_max_n > 0.0 && pass.helix_max_abs_um <= 2.0, "{pass:#?}");
    }
    // The tool stands further out than the crest of 13.1 mm.
    let first = cutting(&summary.passes[0]);
    let radius_mm = 1e3 * first.torque_max_nm / first.force_max_n;
    assert!((13.1..14.0).contains(&radius_mm), "{radius_mm} mm");
}

#[test]
fn the_cut_is_the_same_over_processes_and_in_one() {
    let place = Place::new();
    let machine = steel(&place);
    let inside = run(&place, "inside", &["--in-process", "--machine", &machine]);
    let over_processes = run(&place, "processes", &["--machine", &machine]);
    assert_eq!(over_processes.trace_hash, inside.trace_hash);
    assert_eq!(over_processes.passes, inside.passes);
    assert!(inside.passes.iter().all(|pass| pass.cutting.is_some()));
}

#[test]
fn the_figures_of_the_page_are_those_of_a_run() {
    let place = Place::new();
    let machine = steel(&place);
    let summary = run(&place, "steel", &["--in-process", "--machine", &machine]);
    let row = |pass: &PassReport| {
        let cut = cutting(pass);
        format!(
            "| {} | {:.3} | {:.4} | {:.0} | {:.0} | {:.0} | {:.2} | {:.3} | {:.1} | {:.2} |",
            pass.pass,
            pass.depth_mm,
            cut.chip_area_max_mm2,
            cut.force_max_n,
            cut.radial_max_n,
            cut.axial_max_n,
            cut.torque_max_nm,
            cut.power_max_kw,
            pass.rpm_min,
            pass.tool.helix_max_abs_um,
        )
    };
    page_says(&summary.passes.iter().map(row).collect::<Vec<_>>().join("\n"));
}
