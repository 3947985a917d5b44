//! GO and NO-GO. In: what tools did ([`Sections`]), what is asked ([`Nominal`]), where the thread is at full
//! depth, mm. Out: a [`Report`].
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | a, b, H | mm | what each groove leaves to a counterpart (M153), and its place on an even helix (M154) |
//! | w, T | mm, – | width of a groove at the pitch line; tangents of both flanks together |
//! | δ | mm | height of the virtual pitch line over that of the GO gauge |
//!
//! ```text
//! (M155) δ = (max (a − H) − min (b − H) + w)/T   over every length of the gauge;   GO: δ ≤ 0
//!        NO-GO: h_s ≥ h of its limit, everywhere
//! (M192) standoff of a taper: 2 (δ − ½ h of the limit of NO-GO)/|taper|
//! ```
//! A ridge of the counterpart whose pitch line is at δ needs c − w/2 + δ t₁ ≥ a − H at one flank and c +
//! w/2 − δ t₂ ≤ b − H at the other; the phase c drops out of their sum. So this is the smallest
//! counterpart that can be screwed on, whatever makes the grooves narrow: depth, lead, drunkenness,
//! flanks, starts. Both gauges are held on the axis of the spindle. The gauge of a taper comes to rest
//! where it fits; that is told as a diameter at its plane, and as its distance from there.

use crate::{
    blunt,
    causes::{Held, angles_deg, causes, mean_tangents},
    groove::{Cut, Measure},
    helix::{self, Helix, Thread},
    nominal::Nominal,
    reason::{self, Cause, Check, Reason},
    section::{self, Sections},
    window,
};

/// What the gauges say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// GO goes on, NO-GO does not.
    Good,
    /// At least one of them refuses.
    Bad,
    /// There is nothing to hold them against.
    #[default]
    None,
}

/// What was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// What the gauges say.
    pub verdict: Verdict,
    /// Why they refuse.
    pub reasons: Vec<Reason>,
    /// Smallest and largest pitch diameter, mm; on a cone, at its plane.
    pub pitch_diameter_mm: [f64; 2],
    /// Virtual pitch diameter: that of the tightest place, mm.
    pub virtual_mm: f64,
    /// Of a taper: how far before its plane GO comes to rest, by hand; negative where it goes beyond (M192),
    /// mm.
    pub standoff_mm: Option<f64>,
    /// Error of the lead over the length of the GO gauge, or of the thread if that is shorter, µm.
    pub lead_error_um: f64,
    /// Largest unevenness of the helix within a turn, µm.
    pub drunkenness_um: f64,
    /// Largest distance of two starts from where they belong, µm.
    pub starts_um: f64,
    /// Change of the pitch diameter over that length, µm; growing with Z positive.
    pub taper_um: f64,
    /// How far the pitch line moves while the thread is turned, µm.
    pub runout_um: f64,
    /// Flanks towards lower and higher Z, degrees.
    pub flank_deg: [f64; 2],
    /// Smallest and largest diameter of the root, mm.
    pub root_mm: [f64; 2],
    /// Depth of the groove, mm, if the stock is known.
    pub depth_mm: Option<f64>,
    /// Of a blunt start: turns behind the face up to which the ridge is gone, and from which on it is whole.
    pub blunt_turns: Option<[f64; 2]>,
    /// Length of the thread that was measured, mm.
    pub length_mm: f64,
}

/// Judges the thread between two places along Z, where it is at full depth, in a stock of a diameter if that
/// is known.
///
/// # Panics
/// If `nominal` does not pass [`Nominal::check`], or a place names an edge that is not there.
#[must_use]
pub fn judge(nominal: &Nominal, sections: &Sections, full_mm: [f64; 2], crest_mm: Option<f64>) -> Report {
    assert!(nominal.check().is_ok(), "{nominal:?}");
    let measure = Measure::new(nominal, crest_mm);
    let edges: Vec<_> = sections.edges.iter().map(crate::Edge::flanks).collect();
    let (mut deepest, mut ridge) = (f64::INFINITY, true);
    let cuts = sections.stations.iter().map(|places| {
        let (grooves, deep) = section::grooves(nominal, &edges, places);
        deepest = deepest.min(deep);
        ridge &= grooves.iter().all(|groove| groove.within(full_mm) < nominal.pitch_mm);
        grooves.iter().map(|groove| measure.cut(groove)).collect()
    });
    let cuts: Vec<Vec<Cut>> = cuts.collect();
    if !ridge {
        return no_ridge(nominal, deepest);
    }
    let Thread { mut cuts, goes_on } = helix::link(nominal, 0.5 * (full_mm[0] + full_mm[1]), cuts);
    cuts.retain(|cut| (full_mm[0]..=full_mm[1]).contains(&cut.middle));
    if cuts.is_empty() {
        return nothing(nominal, deepest);
    }
    cuts.sort_by(|a, b| a.nominal.total_cmp(&b.nominal));
    if let Some(wrong) = goes_on.and_then(|grooves| other_grooves(nominal, grooves)) {
        return refused(wrong);
    }
    let helix = Helix::of(nominal, &cuts);
    let mut report = measures(nominal, &helix, &cuts, crest_mm);
    report.length_mm = length(&cuts);
    {
        let heights = nominal.flank_heights_mm(crest_mm);
        let tight = tightest(nominal, &cuts);
        let simple = cuts.iter().map(|cut| cut.simple).fold(f64::INFINITY, f64::min);
        let no_go = nominal.height_mm(nominal.no_go_mm());
        report.virtual_mm = nominal.diameter_mm(tight.height);
        report.standoff_mm =
            (nominal.taper != 0.0).then(|| 2.0 * (tight.height - 0.5 * no_go) / nominal.taper.abs());
        let depth_helps = simple - tight.height >= no_go;
        let held = Held { cuts: &cuts, rest: &helix.rest, heights, depth_helps };
        if tight.height > 0.0 {
            let on = Held { cuts: &cuts[tight.on.clone()], rest: &helix.rest[tight.on], ..held };
            report.reasons.push(refusal(nominal, Check::Go, report.virtual_mm, &helix, &on));
        }
        if simple < no_go {
            report.reasons.push(refusal(nominal, Check::NoGo, nominal.diameter_mm(simple), &helix, &held));
        }
    }
    report.reasons.extend(root(nominal, report.root_mm));
    report.reasons.extend(crest(nominal, &cuts, crest_mm));
    if let Some(asked) = nominal.blunt_turns {
        let heights = [nominal.flank_heights_mm(crest_mm)[0], measure.crest];
        let start = blunt::look(nominal, asked, sections, (&cuts, full_mm), heights);
        report.blunt_turns = Some(start.turns);
        report.reasons.extend(start.reasons);
    }
    report.verdict = if report.reasons.is_empty() { Verdict::Good } else { Verdict::Bad };
    report
}

/// Length of a thread along the axis, mm.
fn length(cuts: &[Cut]) -> f64 {
    let low = cuts.iter().map(|cut| cut.middle).fold(f64::INFINITY, f64::min);
    cuts.iter().map(|cut| cut.middle).fold(f64::NEG_INFINITY, f64::max) - low
}

/// No groove reaches the pitch line: is there any?
fn nothing(nominal: &Nominal, deepest: f64) -> Report {
    if !deepest.is_finite() || deepest <= 0.0 {
        return Report::default();
    }
    let text = format!(
        "the groove does not reach the pitch line: {}",
        reason::beyond("root", nominal.diameter_mm(deepest), nominal.go_mm())
    );
    refused(Reason { check: Check::Root, cause: Cause::Size, text })
}

/// A turn goes on by another number of grooves than there should be starts.
fn other_grooves(nominal: &Nominal, goes_on: i64) -> Option<Reason> {
    let starts = i64::from(nominal.starts);
    let expected = if nominal.grows { starts } else { -starts };
    let (cause, text) = if goes_on == expected {
        return None;
    } else if goes_on == -expected {
        (Cause::Hand, "the thread is wound the other way".into())
    } else {
        (Cause::Starts, format!("number of starts: {}, not {starts}", goes_on.abs()))
    };
    Some(Reason { check: Check::Grooves, cause, text })
}

/// The figures of a thread.
fn measures(nominal: &Nominal, helix: &Helix, cuts: &[Cut], crest_mm: Option<f64>) -> Report {
    let span = |of: &dyn Fn(&Cut) -> f64| {
        let [a, b] = [f64::min, f64::max].map(|pick| {
            let all = cuts.iter().map(|cut| nominal.diameter_mm(of(cut)));
            all.reduce(pick).unwrap_or_default()
        });
        [a, b]
    };
    let along = nominal.gauge_mm.min(length(cuts));
    let root_mm = span(&|cut| cut.root);
    Report {
        pitch_diameter_mm: span(&|cut| cut.simple),
        lead_error_um: 1e3 * helix.lead * along,
        drunkenness_um: 1e3 * helix.drunken,
        starts_um: 1e3 * helix.starts,
        taper_um: 2e3 * nominal.sign() * helix.taper * along,
        runout_um: 1e3 * helix.runout,
        flank_deg: angles_deg(mean_tangents(nominal, cuts)),
        root_mm,
        depth_mm: crest_mm.map(|crest| 0.5 * (crest - root_mm[0]).abs().max((crest - root_mm[1]).abs())),
        ..Report::default()
    }
}

/// Where GO is tightest.
struct Tight {
    /// δ (M155).
    height: f64,
    /// Which cuts it is held against there.
    on: std::ops::Range<usize>,
}

/// δ over every length of the gauge (M155); there are cuts.
fn tightest(nominal: &Nominal, cuts: &[Cut]) -> Tight {
    let places: Vec<f64> = cuts.iter().map(|cut| cut.nominal).collect();
    let begins = window::begins(&places, nominal.gauge_mm);
    let low = window::largest(&begins, |i| cuts[i].clears[0] - cuts[i].nominal);
    let high = window::largest(&begins, |i| cuts[i].nominal - cuts[i].clears[1]);
    let heights = low.iter().zip(high).map(|(a, b)| (a + b + nominal.width_mm()) / nominal.tangent());
    let most = heights.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    most.map_or(Tight { height: 0.0, on: 0..cuts.len() }, |(last, height)| Tight {
        height,
        on: begins[last]..last + 1,
    })
}

/// GO or NO-GO refuses at a diameter: why.
fn refusal(nominal: &Nominal, check: Check, diameter_mm: f64, helix: &Helix, held: &Held) -> Reason {
    let causes = causes(nominal, check, helix, held);
    let told: Vec<_> = causes.iter().map(|(cause, told)| reason::cause(nominal, *cause, *told)).collect();
    reason::pitch(nominal, check, diameter_mm, causes[0].0, &told.join(", "))
}

/// The grooves meet: no ridge stands between them that a gauge could find.
fn no_ridge(nominal: &Nominal, deepest: f64) -> Report {
    let text = format!(
        "no ridge is left between the grooves at {:.3} mm, the pitch line of GO: {}, cut down to {:.3} mm",
        nominal.go_mm(),
        "another thread, or far too deep",
        nominal.diameter_mm(deepest)
    );
    refused(Reason { check: Check::Grooves, cause: Cause::Ridge, text })
}

/// No thread that could be measured.
fn refused(reason: Reason) -> Report {
    Report { verdict: Verdict::Bad, reasons: vec![reason], ..Report::default() }
}

/// The diameter of the root against its limits.
fn root(nominal: &Nominal, root_mm: [f64; 2]) -> Option<Reason> {
    let [mut least, mut most] = nominal.root_mm;
    if nominal.sign() > 0.0 {
        most = [most, nominal.root_go_mm].into_iter().flatten().reduce(f64::min);
    } else {
        least = [least, nominal.root_go_mm].into_iter().flatten().reduce(f64::max);
    }
    let out = outside(root_mm, [least, most])?;
    Some(reason::diameter(nominal, Check::Root, Cause::Size, out))
}

/// The diameter of the crest against its limits: of the stock, and where grooves have eaten the ridge.
fn crest(nominal: &Nominal, cuts: &[Cut], crest_mm: Option<f64>) -> Option<Reason> {
    if let Some(out) = crest_mm.and_then(|mm| outside([mm; 2], nominal.crest_mm)) {
        return Some(reason::diameter(nominal, Check::Crest, Cause::Stock, out));
    }
    nominal.crest_mm[if nominal.sign() > 0.0 { 0 } else { 1 }]?;
    let mut by_groove: Vec<&Cut> = cuts.iter().collect();
    by_groove.sort_by_key(|cut| (cut.station, cut.groove));
    let eaten = by_groove.windows(2).any(|pair| {
        pair[0].station == pair[1].station
            && pair[0].groove + 1 == pair[1].groove
            && pair[0].crest[1] > pair[1].crest[0]
    });
    let text = "crest: the ridge between the grooves ends below its limit".into();
    eaten.then_some(Reason { check: Check::Crest, cause: Cause::Size, text })
}

/// A diameter that is beyond a limit, and the limit.
fn outside([low, high]: [f64; 2], [least, most]: [Option<f64>; 2]) -> Option<(f64, f64)> {
    let below = least.filter(|least| low < *least).map(|least| (low, least));
    below.or(most.filter(|most| high > *most).map(|most| (high, most)))
}
