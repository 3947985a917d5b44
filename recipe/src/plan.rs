//! From a thread and what is wished to a recipe. In: name, tool, wishes. Out: diameters, depths and places in
//! mm, speed in 1/min, each rounded to what a program can say.
//!
//! ```text
//! (M203) tip of the tool at full depth:  d₂ ∓ 2 v of a screw and of a nut,  v of (M200) for w of (M150)
//! ```
//! d₂ is the middle of its limits, so is the crest; without limits of the crest it is that of the basic
//! profile. On a cone they hold where its standard measures it.

use std::fmt;

use gauge::{Edge, Nominal, NominalError, Side};
use metrology::{Size, Thread};

use crate::force::tangential_n;
use crate::infeed::{DEEPEST_CUT_MM, MOST, passes};
use crate::{Infeed, Law, Material, Order, Sequence, Tool};

/// Why there is no recipe.
#[derive(Clone, Debug, PartialEq)]
pub enum Refused {
    /// The name alone does not say what is to be made.
    Thread(NominalError),
    /// The tool is not for this thread.
    Tool {
        /// The tool.
        tool: String,
        /// Why.
        text: String,
    },
    /// A wish is out of range.
    Wish {
        /// Which.
        what: &'static str,
        /// What is wrong, and what would be right.
        text: String,
    },
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refused::Thread(NominalError::Side) => {
                f.write_str("the screw or the nut? add the class of one of them, as in M20x2-6g or M20x2-6H, or external or internal")
            }
            Refused::Thread(why) => write!(f, "{why}: {}", why.help()),
            Refused::Tool { tool, text } => write!(f, "tool {tool} does not cut this thread: {text}"),
            Refused::Wish { what, text } => write!(f, "{what}: {text}"),
        }
    }
}

impl std::error::Error for Refused {}

/// A pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Depth below the crest, mm of radius.
    pub depth_mm: f64,
    /// Where it runs beside the groove, mm, positive towards higher Z.
    pub beside_mm: f64,
    /// What it takes, mm².
    pub area_mm2: f64,
    /// Its tangential force, N (M209).
    pub force_n: f64,
}

/// How a thread is cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Recipe {
    /// What is made.
    pub thread: Thread,
    /// What its gauges ask.
    pub nominal: Nominal,
    /// What cuts it.
    pub tool: Tool,
    /// The edge of that in this thread.
    pub edge: Edge,
    /// Width of its tip as a machine file has it, corners and all; 0 of a round one, mm.
    pub width_mm: f64,
    /// Its number.
    pub tool_number: u32,
    /// Material.
    pub material: Material,
    /// Diameter of the crest, mm; of a cone at Z 0.
    pub crest_mm: f64,
    /// Diameter at which the tip of the tool ends, mm; of a cone at Z 0.
    pub root_mm: f64,
    /// Diameter at which the tool goes back, mm.
    pub clear_mm: f64,
    /// Full depth, mm of radius.
    pub depth_mm: f64,
    /// The passes, springs not among them.
    pub passes: Vec<Pass>,
    /// How often the full depth is cut again.
    pub springs: u32,
    /// How deep the passes go.
    pub law: Law,
    /// Where beside the groove they run.
    pub infeed: Infeed,
    /// Change of radius along Z.
    pub slope: f64,
    /// Advance in a turn, mm.
    pub lead_mm: f64,
    /// Spindle speed, 1/min.
    pub s_rpm: f64,
    /// Where the first start begins, mm along Z; the face is at 0.
    pub start_mm: f64,
    /// Where all starts end, mm along Z.
    pub end_mm: f64,
    /// Length of full thread that is meant, mm.
    pub length_mm: f64,
    /// Order of the starts.
    pub sequence: Sequence,
    /// Whether the crest is turned before.
    pub turn: bool,
    /// Every pass is written out, even where a cycle says the same.
    pub written_out: bool,
}

/// What a program can say, mm.
const STEP_MM: f64 = 0.001;
/// How far from the crest the tool goes back, mm of radius.
const CLEAR_MM: f64 = 1.0;
/// The start: so many leads before the face, this way at least, mm.
const START_LEADS: f64 = 4.0;
const LEAST_START_MM: f64 = 5.0;

impl Recipe {
    /// How a thread is cut.
    ///
    /// # Errors
    /// The name says neither screw nor nut or has no limits, the tool is not for it, a wish is out of range.
    pub fn of(thread: &Thread, order: &Order) -> Result<Recipe, Refused> {
        wishes(order)?;
        let nominal = nominal(thread, order)?;
        let profile = thread.profile();
        let side = nominal.side;
        let [width_mm, nose_mm] = order.tool.tip_mm(thread, side)?;
        let edge = Edge::of_width(profile.flank_deg, width_mm, nose_mm);
        // Towards and away from the axis: the tool goes into a screw inwards.
        let inwards = if side == Side::External { -1.0 } else { 1.0 };
        let slope = 0.5 * nominal.taper;
        let at_face = |diameter_mm: f64| diameter_mm - nominal.taper * nominal.plane_mm;
        let pitch_diameter = at_face(middle(nominal.pitch_diameter_mm));
        let crest_mm = 2.0 * rounded(0.5 * crest(thread, &nominal, pitch_diameter));
        let below = edge
            .depth_mm(groove_mm(&nominal))
            .ok_or_else(|| blunt(order, "its tip is wider than the groove"))?;
        let depth_mm = rounded(inwards * (0.5 * pitch_diameter + inwards * below - 0.5 * crest_mm));
        let root_mm = crest_mm + 2.0 * inwards * depth_mm;
        let go = nominal.root_go_mm.map(at_face);
        if go.is_some_and(|go| inwards * (root_mm - go) < 0.0) {
            return Err(blunt(order, "its tip is too blunt to reach the root that a GO gauge needs"));
        }
        let length_mm = order.length_mm.unwrap_or_else(|| engaged(thread, &nominal));
        let start_mm =
            order.start_mm.unwrap_or_else(|| (START_LEADS * profile.lead_mm()).max(LEAST_START_MM).ceil());
        let law = order.law.unwrap_or(if edge.flat_mm > 0.0 { Law::EqualArea } else { Law::Root });
        let is_alike = edge.flank_deg[0] == edge.flank_deg[1];
        let infeed = order.infeed.unwrap_or(if is_alike { Infeed::Flank } else { Infeed::Radial });
        let widest = [start_mm, -length_mm].map(|z| crest_mm + nominal.taper * z);
        let clear_mm = match side {
            Side::External => widest[0].max(widest[1]).max(crest_mm) + 2.0 * CLEAR_MM,
            Side::Internal => widest[0].min(widest[1]).min(crest_mm) - 2.0 * CLEAR_MM,
        };
        if clear_mm <= 0.0 {
            let text = format!("a hole of {crest_mm:.3} mm leaves the tool no way back");
            return Err(Refused::Wish { what: "thread", text });
        }
        let mut recipe = Recipe {
            thread: thread.clone(),
            tool: order.tool.clone(),
            edge,
            width_mm,
            tool_number: order.tool_number,
            material: order.material,
            crest_mm,
            root_mm,
            clear_mm: clear_mm.ceil(),
            depth_mm,
            passes: Vec::new(),
            springs: order.springs,
            law,
            infeed,
            slope,
            lead_mm: profile.lead_mm(),
            s_rpm: even(order.s_rpm.unwrap_or_else(|| order.material.rpm(crest_mm)).min(order.most_rpm)),
            start_mm,
            end_mm: -length_mm,
            length_mm,
            sequence: order.sequence,
            turn: order.turn,
            written_out: order.written_out,
            nominal,
        };
        if side == Side::Internal {
            recipe.clear_mm = clear_mm.floor().max(0.5 * clear_mm);
        }
        recipe.passes = recipe.cut(order)?;
        Ok(recipe)
    }

    /// The passes: as many as are wished, else as many as keep the first cut, force and power within what is
    /// allowed.
    fn cut(&self, order: &Order) -> Result<Vec<Pass>, Refused> {
        let limit_n = order.most_force_n.unwrap_or(f64::INFINITY).min(
            // P = F v, v in m/min.
            order.most_power_kw.map_or(f64::INFINITY, |kw| 60e3 * kw / self.speed_m_min()),
        );
        let of = |passes| self.passes_of(passes, order.least_mm);
        if let Some(passes) = order.passes {
            return Ok(of(passes));
        }
        let least = passes(self.nominal.pitch_mm);
        let mut cut = (least..=MOST).map(of).filter(|cut| cut[0].depth_mm <= DEEPEST_CUT_MM + STEP_MM);
        let heaviest = |cut: &Vec<Pass>| cut.iter().map(|pass| pass.force_n).fold(0.0, f64::max);
        if limit_n == f64::INFINITY {
            return Ok(cut.next().unwrap_or_else(|| of(MOST)));
        }
        let mut lightest = f64::INFINITY;
        for cut in cut {
            let force = heaviest(&cut);
            if force <= limit_n {
                return Ok(cut);
            }
            lightest = lightest.min(force);
        }
        let text = format!(
            "{lightest:.0} N is the least that {MOST} passes come to with cuts of {} mm at least, {limit_n:.0} N are allowed: \
             lower the least cut, take another law or infeed, or allow more",
            order.least_mm
        );
        Err(Refused::Wish { what: "force", text })
    }

    /// So many passes, or fewer where cuts would be shallower than `least_mm`.
    fn passes_of(&self, passes: u32, least_mm: f64) -> Vec<Pass> {
        let depths = self.law.depths_mm(&self.edge, self.depth_mm, passes, least_mm);
        let (mut before, mut last) = (0.0, 0.0);
        let count = depths.len();
        let pass = |(n, depth): (usize, f64)| {
            // Up to the last one, so that a cycle that begins with the first ends in as many.
            let depth_mm =
                if n + 1 == depths.len() { depth } else { (depth / STEP_MM - 1e-6).ceil() * STEP_MM };
            let area = self.edge.area_mm2(depth_mm);
            let area_mm2 = area - std::mem::replace(&mut before, area);
            let depths = [std::mem::replace(&mut last, depth_mm), depth_mm, self.depth_mm];
            let beside_mm = self.infeed.beside_mm((n, count), depths, self.edge.flank_deg, -1.0);
            let cut = [depth_mm, area_mm2];
            let force_n = tangential_n(self.material, &self.edge, self.infeed, n == 0, cut);
            Pass { depth_mm, beside_mm, area_mm2, force_n }
        };
        depths.iter().copied().enumerate().map(pass).collect()
    }

    /// Number and name of the tool that turns the crest.
    #[must_use]
    pub fn turning_tool(&self) -> (u32, &'static str) {
        match self.side() {
            Side::External => (1, "turning tool"),
            Side::Internal => (2, "boring bar"),
        }
    }

    /// Number of starts.
    #[must_use]
    pub fn starts(&self) -> u32 {
        self.nominal.starts
    }

    /// Screw or nut.
    #[must_use]
    pub fn side(&self) -> Side {
        self.nominal.side
    }

    /// Cutting speed at the crest, m/min.
    #[must_use]
    pub fn speed_m_min(&self) -> f64 {
        std::f64::consts::PI * self.crest_mm * self.s_rpm / 1000.0
    }

    /// Torque of a pass at the crest, N·m.
    #[must_use]
    pub fn torque_nm(&self, pass: &Pass) -> f64 {
        0.5e-3 * self.crest_mm * pass.force_n
    }

    /// Power of the pass that takes most, kW: its force times the cutting speed.
    #[must_use]
    pub fn power_kw(&self) -> f64 {
        let most = self.passes.iter().map(|pass| pass.force_n).fold(0.0, f64::max);
        most * self.speed_m_min() / 60e3
    }

    /// The same at another speed of the spindle, 1/min.
    #[must_use]
    pub fn at_rpm(self, s_rpm: f64) -> Recipe {
        Recipe { s_rpm: even(s_rpm), ..self }
    }

    /// The same with another programmed end, mm along Z.
    #[must_use]
    pub fn to_end_mm(self, end_mm: f64) -> Recipe {
        Recipe { end_mm: (end_mm * 10.0).floor() / 10.0, ..self }
    }
}

fn rounded(mm: f64) -> f64 {
    (mm / STEP_MM).round() * STEP_MM
}

/// A speed that people would write, not above the given one, 1/min.
fn even(rpm: f64) -> f64 {
    let step = if rpm > 200.0 { 10.0 } else { 1.0 };
    (rpm / step).floor().max(1.0) * step
}

fn middle([least, most]: [f64; 2]) -> f64 {
    0.5 * (least + most)
}

/// Width of the groove at the pitch line, mm (M150).
fn groove_mm(nominal: &Nominal) -> f64 {
    let tangents = nominal.flank_deg.map(|deg| libm::tan(deg.to_radians()));
    let slope = 0.5 * nominal.taper;
    0.5 * nominal.pitch_mm * (1.0 - slope * slope * tangents[0] * tangents[1])
}

/// Diameter of the crest at Z 0, mm.
fn crest(thread: &Thread, nominal: &Nominal, pitch_diameter_mm: f64) -> f64 {
    let profile = thread.profile();
    let basic = if nominal.side == Side::External { profile.major_mm } else { profile.minor_mm };
    match nominal.crest_mm {
        [Some(least), Some(most)] => middle([least, most]),
        // The nearer half of a limit on one side is the basic size.
        [Some(least), None] => least.max(basic),
        [None, Some(most)] => most.min(basic),
        [None, None] => pitch_diameter_mm + basic - profile.pitch_diameter_mm,
    }
}

/// Length that usually engages, mm.
fn engaged(thread: &Thread, nominal: &Nominal) -> f64 {
    let limits = thread.limits();
    let effective = limits.members().find_map(|(_, member)| member.get(Size::EffectiveLength));
    let mm =
        if nominal.taper == 0.0 { nominal.gauge_mm } else { effective.unwrap_or(1.5 * nominal.gauge_mm) };
    (mm * 10.0).ceil() / 10.0
}

fn blunt(order: &Order, text: &str) -> Refused {
    Refused::Tool { tool: order.tool.name.clone(), text: text.into() }
}

/// What its gauge asks: of its name, or of the limits that are wished.
fn nominal(thread: &Thread, order: &Order) -> Result<Nominal, Refused> {
    let Some([least, most]) = order.pitch_diameter_mm else {
        return Nominal::of(thread).map_err(Refused::Thread);
    };
    let profile = thread.profile();
    let side = match thread.side().ok_or(Refused::Thread(NominalError::Side))? {
        Side::External => "external",
        Side::Internal => "internal",
    };
    let [hand, starts, taper] = [
        if profile.left_hand { " LH".into() } else { String::new() },
        if profile.starts == 1 { String::new() } else { format!(" starts {}", profile.starts) },
        if profile.taper == 0.0 { String::new() } else { format!(" taper 1:{}", 1.0 / profile.taper) },
    ];
    let angle: f64 = profile.flank_deg.iter().sum();
    let pitch = (profile.pitch_mm * 1e6).round() / 1e6;
    let text = format!("P{pitch} D2 {least:.4}..{most:.4} A{angle} {side}{hand}{starts}{taper}");
    text.parse()
        .map_err(|misread: metrology::Misread| Refused::Wish { what: "limits", text: misread.message })
}

/// Whether the wishes are in their ranges.
fn wishes(order: &Order) -> Result<(), Refused> {
    let range = |what, value: Option<f64>, [least, most]: [f64; 2]| match value {
        Some(value) if !(least..=most).contains(&value) => {
            Err(Refused::Wish { what, text: format!("{value} is not within {least} to {most}") })
        }
        _ => Ok(()),
    };
    range("length", order.length_mm, [0.1, 2000.0])?;
    range("start", order.start_mm, [0.1, 500.0])?;
    range("speed", order.s_rpm, [1.0, order.most_rpm])?;
    range("passes", order.passes.map(f64::from), [1.0, f64::from(MOST)])?;
    range("force", order.most_force_n, [1.0, 1e6])?;
    range("power", order.most_power_kw, [0.001, 1000.0])?;
    range("springs", Some(f64::from(order.springs)), [0.0, 20.0])?;
    range("least cut", Some(order.least_mm), [0.001, 0.5])?;
    range("tool number", Some(f64::from(order.tool_number)), [1.0, 99.0])?;
    match order.infeed {
        Some(Infeed::Modified(off)) => range("degrees off the flank", Some(off), [0.0, 30.0]),
        _ => Ok(()),
    }
}
