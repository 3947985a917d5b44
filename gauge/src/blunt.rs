//! A blunt start: the ridge is gone behind the face of the part, up to where it is whole. In: what tools did
//! ([`Sections`]), the grooves of the thread, mm. Out: how many turns behind the face, and what is wrong.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | u | rev | how far a groove lies behind the face, which is at Z 0, in turns |
//! | A, B | rev | up to where the ridge has to be gone, and from where on whole |
//! | h(z) | mm | height over the pitch line of the GO gauge of what the tools leave; v as in (M160) |
//! | r | mm | height of the ridge in front of a groove |
//!
//! ```text
//! (M250) h(z) = min (y_i + v(z − z_i)) − y_go(z);   r = max h(z) over one pitch from the middle of a groove
//!        towards the face, to the face at most;   u ≤ A: r ≤ h_r,   B ≤ u ≤ B + 1: r ≥ h_c
//! ```
//! h_r is how deep a GO gauge reaches, h_c the least crest, or the stock. A groove that is nearer to the face
//! than half a pitch has no whole ridge in front of it, blunt or not.

use crate::{
    groove::Cut,
    nominal::Nominal,
    reason::{Cause, Check, Reason},
    section::{Place, Sections},
};

/// Places at which a ridge is looked at.
const LOOKS: u32 = 200;

/// A ridge in front of a groove.
#[derive(Clone, Copy, Debug)]
struct Ridge {
    /// u.
    turns: f64,
    /// r.
    height: f64,
    /// Whether there is room for a whole one.
    has_room: bool,
}

/// What is found of a blunt start.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    /// Turns behind the face up to which the ridge is gone, and from which on it is whole.
    pub(crate) turns: [f64; 2],
    /// What is wrong with it.
    pub(crate) reasons: Vec<Reason>,
}

/// Looks at the start of a thread whose grooves are measured between two places along Z; there are cuts.
/// `heights` are h_r and h_c.
pub(crate) fn look(
    nominal: &Nominal,
    [gone, whole]: [f64; 2],
    sections: &Sections,
    (cuts, full_mm): (&[Cut], [f64; 2]),
    [root, crest]: [f64; 2],
) -> Start {
    let phase = cuts.iter().map(|cut| cut.middle - cut.nominal).sum::<f64>() / cuts.len() as f64;
    let inwards = (full_mm[0] + full_mm[1]).signum();
    let (n, pitch, lead) = (sections.stations.len() as f64, nominal.pitch_mm, nominal.lead_mm());
    let mut ridges: Vec<Ridge> = Vec::new();
    for (station, places) in sections.stations.iter().enumerate() {
        let there = phase + nominal.advance_mm() * station as f64 / n;
        let first = (there * inwards).rem_euclid(pitch);
        let behind = (0_u32..).map(|groove| first + pitch * f64::from(groove));
        for behind in behind.take_while(|mm| *mm <= (whole + 1.0) * lead) {
            let height = height(nominal, sections, places, [behind, (behind - pitch).max(0.0)], inwards);
            ridges.push(Ridge { turns: behind / lead, height, has_room: behind >= 0.5 * pitch });
        }
    }
    ridges.sort_by(|a, b| a.turns.total_cmp(&b.turns));
    let stands = ridges.iter().find(|ridge| ridge.height > root);
    let is_cut_down = |ridge: &&Ridge| ridge.has_room && ridge.height < crest;
    let cut_down = ridges.iter().rfind(is_cut_down);
    let too_early = stands.filter(|ridge| ridge.turns <= gone);
    let too_late = ridges.iter().find(|ridge| ridge.turns >= whole && is_cut_down(ridge));
    let of = |ridge: &Ridge| (ridge.turns, nominal.diameter_mm(ridge.height));
    let early = too_early.map(of).map(|(turns, mm)| {
        format!("{turns:.2} turns behind the face the ridge stands at {mm:.3} mm, and it has to be gone for {gone}")
    });
    let late = too_late.map(of).map(|(turns, mm)| {
        format!("{turns:.2} turns behind the face the ridge ends at {mm:.3} mm, and it has to be whole from {whole} on")
    });
    let reason =
        |text| Reason { check: Check::Start, cause: Cause::Size, text: format!("blunt start: {text}") };
    Start {
        turns: [stands.map_or(whole + 1.0, |ridge| ridge.turns), cut_down.map_or(0.0, |ridge| ridge.turns)],
        reasons: [early, late].into_iter().flatten().map(reason).collect(),
    }
}

/// r: the highest of what is left between two distances behind the face, `inwards` the sign of Z behind it.
fn height(
    nominal: &Nominal,
    sections: &Sections,
    places: &[Place],
    [from, to]: [f64; 2],
    inwards: f64,
) -> f64 {
    let most = 2.0 * nominal.pitch_mm;
    let near = |place: &&Place| (to - most..=from + most).contains(&(place.z_mm * inwards));
    let near: Vec<&Place> = places.iter().filter(near).collect();
    let left = |look: u32| {
        let z = inwards * (from + (to - from) * f64::from(look) / f64::from(LOOKS));
        let over = |place: &&Place| {
            let edge = &sections.edges[place.edge];
            nominal.sign() * place.radius_mm + edge.height_mm(z - place.z_mm)
        };
        near.iter().map(over).fold(f64::INFINITY, f64::min) - nominal.line_mm(z)
    };
    (0..=LOOKS).map(left).fold(f64::NEG_INFINITY, f64::max)
}
