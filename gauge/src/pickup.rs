//! Where a thread that is there lies, from touches: phase, lead and taper by least squares, with limits of
//! confidence. In: spindle angle in degrees from the index, Z and perhaps X of a probe that sits in the
//! groove, mm. Out: a [`Found`], or why nothing can be said.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | Cᵢ, zᵢ, xᵢ | °, mm, mm | a touch: angle in the direction of the spindle, Z, X (radius) |
//! | L₀, n, P | mm, –, mm | nominal lead, signed by the direction of motion; starts; P = L₀/n |
//! | a | mm | the probe is off by so much at most |
//! | σ | mm | a/√3: standard deviation of an error that is anywhere within ±a |
//! | uᵢ | – | leads from the groove at angle 0 |
//! | z̄, L | mm | phase: Z of the groove at the middle ū of the touches; lead |
//!
//! ```text
//! uᵢ = Cᵢ/360 + kᵢ/n,  kᵢ = round((zᵢ − z₁ − L₀ (Cᵢ − C₁)/360)/P)                                   (M174)
//! z̄ = mean zᵢ,  L = Σ (uᵢ − ū)(zᵢ − z̄)/S,  S = Σ (uᵢ − ū)²;
//!     ± q(1/m) σ/√m,  ± q(Σ (uᵢ − ū)⁴/S²) σ/√S,  q(w) = 1.95996 − 0.0825 w                        (M175)
//! χ² = Σ (zᵢ − z̄ − L (uᵢ − ū))²/σ² ≤ ν (1 − 2/(9ν) + 3.0902 √(2/(9ν)))³,  ν = m − 2                (M176)
//! ```
//! q is the quantile of a sum of errors that are anywhere within ±a: that of a normal distribution (w = 0),
//! corrected by their kurtosis −1.2 w (Cornish and Fisher). (M176) is the cube of Wilson and Hilferty: one
//! sound thread in a thousand is refused. Taper is the same line of x over z. Which turn a touch belongs to
//! is known only if what the lead may be off does not come to a quarter of P between the first touch and
//! the last.

/// Fewest touches.
pub const FEWEST: usize = 3;
/// Half the width of what holds 95 of 100 of a normal distribution, and what it is less for each unit of w.
const WIDE: f64 = 1.959_964;
const LESS: f64 = 0.0825;
/// That of 999 of 1000 on one side.
const SOUND: f64 = 3.0902;

/// The probe in the groove.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Angle from the index, in the direction of the spindle, degrees; unwrapped or not.
    pub angle_deg: f64,
    /// Z, mm.
    pub z_mm: f64,
    /// X as a radius, mm, if it was measured.
    pub x_mm: Option<f64>,
}

/// Touches as a file has them: a line for each, with an angle, Z, and perhaps X; `#` begins a comment.
///
/// # Errors
/// Names the line that is not one.
pub fn touches(text: &str) -> Result<Vec<Touch>, String> {
    let mut touches = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.split('#').next().unwrap_or_default();
        let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        let number =
            |word: &str| word.parse::<f64>().map_err(|_| format!("line {line}: {word} is not a number"));
        match *words.map(number).collect::<Result<Vec<f64>, String>>()? {
            [] => {}
            [angle_deg, z_mm] => touches.push(Touch { angle_deg, z_mm, x_mm: None }),
            [angle_deg, z_mm, x_mm] => touches.push(Touch { angle_deg, z_mm, x_mm: Some(x_mm) }),
            _ => return Err(format!("line {line}: a touch is an angle, Z, and perhaps X")),
        }
    }
    Ok(touches)
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked {
    /// Nominal lead, mm per turn, signed by the direction of motion along Z; not 0.
    pub lead_mm: f64,
    /// Starts of the thread, 1 or more.
    pub starts: u32,
    /// The probe is off by so much at most, mm, more than 0.
    pub noise_mm: f64,
    /// The lead may be off by so much, mm per turn.
    pub lead_error_mm: f64,
}

/// A value, and what it may be off with a confidence of 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The value.
    pub value: f64,
    /// Half the width of its interval.
    pub within: f64,
}

/// A thread that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Z of the groove at `angle_deg`, mm: where it is known best.
    pub phase_mm: Value,
    /// The angle in the middle of the touches, degrees from 0 to 360.
    pub angle_deg: f64,
    /// Lead, mm per turn.
    pub lead_mm: Value,
    /// Change of X per mm of Z, where X was measured everywhere and Z differs.
    pub taper: Option<Value>,
    /// Largest distance of a touch from the thread that was found, mm.
    pub farthest_mm: f64,
    /// Distance of neighbouring grooves, mm.
    pub pitch_mm: f64,
}

impl Found {
    /// The Z nearest to one, mm, at which a groove goes through angle 0; and what it may be off with a
    /// confidence of 95 %. A pass that starts there enters the groove.
    pub fn start_near(&self, z_mm: f64) -> Value {
        let turns = self.angle_deg / 360.0;
        let at_index = self.phase_mm.value - self.lead_mm.value * turns;
        let grooves = ((z_mm - at_index) / self.pitch_mm).round();
        // The error of the lead counts from the middle of the touches.
        let away = grooves * self.pitch_mm / self.lead_mm.value - turns;
        let within = (self.phase_mm.within.powi(2) + (away * self.lead_mm.within).powi(2)).sqrt();
        Value { value: at_index + grooves * self.pitch_mm, within }
    }
}

/// Why nothing can be said of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotFound {
    /// Fewer than [`FEWEST`] touches.
    TooFew,
    /// A number that is not finite or out of range.
    Number,
    /// All touches are in one place of the thread: nothing can be said of its lead.
    OnePlace,
    /// The touches lie so many turns apart that an allowed error of the lead makes them ambiguous; how many
    /// turns may lie between the first and the last.
    Ambiguous(f64),
    /// The touches are not on one thread of this lead; the farthest is so many mm off.
    BadFit(f64),
    /// They are, but on one of another lead, mm.
    OtherLead(f64),
    /// They are, but X is not on one cone; the farthest is so many mm off.
    BadTaper(f64),
}

/// A straight line through points: mean of u, mean of v, slope, Σ (u − ū)² and Σ (u − ū)⁴.
struct Line {
    u: f64,
    v: f64,
    slope: f64,
    spread: f64,
    fourth: f64,
}

impl Line {
    fn through(points: &[(f64, f64)]) -> Line {
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (u, v) = (mean(|point| point.0), mean(|point| point.1));
        let spread: f64 = points.iter().map(|point| (point.0 - u).powi(2)).sum();
        let slope = points.iter().map(|point| (point.0 - u) * (point.1 - v)).sum::<f64>() / spread;
        let fourth = points.iter().map(|point| (point.0 - u).powi(4)).sum();
        Line { u, v, slope, spread, fourth }
    }

    /// Its slope, of points with an error of standard deviation σ (M175).
    fn slope(&self, sigma: f64) -> Value {
        let quantile = WIDE - LESS * self.fourth / (self.spread * self.spread);
        Value { value: self.slope, within: quantile * sigma / self.spread.sqrt() }
    }

    /// The farthest point, if the line does not fit them with an error of standard deviation σ (M176).
    fn misfit(&self, points: &[(f64, f64)], sigma: f64) -> Result<f64, f64> {
        let off = |point: &(f64, f64)| point.1 - self.v - self.slope * (point.0 - self.u);
        let farthest = points.iter().map(|point| off(point).abs()).fold(0.0, f64::max);
        let sum = points.iter().map(|point| off(point).powi(2)).sum::<f64>() / (sigma * sigma);
        let free = (points.len() - 2) as f64;
        let ninth = 2.0 / (9.0 * free);
        let most = free * (1.0 - ninth + SOUND * ninth.sqrt()).powi(3);
        if sum <= most { Ok(farthest) } else { Err(farthest) }
    }
}

/// Finds a thread by touches of its groove.
///
/// # Errors
/// [`NotFound`]: too few or unfit touches, or a thread that is not the one that is asked for.
pub fn pick_up(touches: &[Touch], asked: &Asked) -> Result<Found, NotFound> {
    let [first, _, _, ..] = touches else { return Err(NotFound::TooFew) };
    let Asked { lead_mm, starts, noise_mm, lead_error_mm } = *asked;
    let sound = |mm: f64| mm.is_finite() && mm.abs() < 1e6;
    let numbers = touches.iter().flat_map(|one| [one.angle_deg / 360.0, one.z_mm, one.x_mm.unwrap_or(0.0)]);
    let positive = noise_mm > 0.0 && lead_mm != 0.0 && starts > 0 && lead_error_mm >= 0.0;
    if !positive || ![lead_mm, noise_mm, lead_error_mm].into_iter().chain(numbers).all(sound) {
        return Err(NotFound::Number);
    }
    let starts = f64::from(starts);
    let (pitch_mm, sigma) = (lead_mm.abs() / starts, noise_mm / 3f64.sqrt());
    // The groove that each touch is in, counted from the first (M174).
    let place = |one: &Touch| {
        let turns = (one.angle_deg - first.angle_deg) / 360.0;
        let grooves = (starts * ((one.z_mm - first.z_mm) / lead_mm - turns)).round();
        (first.angle_deg / 360.0 + turns + grooves / starts, one.z_mm)
    };
    let points: Vec<(f64, f64)> = touches.iter().map(place).collect();
    let line = Line::through(&points);
    let ends = points.iter().fold([f64::MAX, f64::MIN], |[low, high], (u, _)| [low.min(*u), high.max(*u)]);
    if line.spread < 1e-6 {
        return Err(NotFound::OnePlace);
    }
    let most = 0.25 * pitch_mm / lead_error_mm;
    if ends[1] - ends[0] > most {
        return Err(NotFound::Ambiguous(most));
    }
    let farthest_mm = line.misfit(&points, sigma).map_err(NotFound::BadFit)?;
    let lead = line.slope(sigma);
    if (lead.value - lead_mm).abs() > lead_error_mm + lead.within {
        return Err(NotFound::OtherLead(lead.value));
    }
    let xs: Option<Vec<(f64, f64)>> =
        touches.iter().map(|one| one.x_mm.map(|x_mm| (one.z_mm, x_mm))).collect();
    let cone = xs.map(|xs| (Line::through(&xs), xs)).filter(|(cone, _)| cone.spread > 1e-6);
    let taper = cone.map(|(cone, xs)| {
        cone.misfit(&xs, sigma).map_err(NotFound::BadTaper)?;
        Ok(cone.slope(sigma))
    });
    let count = points.len() as f64;
    Ok(Found {
        phase_mm: Value { value: line.v, within: (WIDE - LESS / count) * sigma / count.sqrt() },
        angle_deg: 360.0 * (line.u - line.u.floor()),
        lead_mm: lead,
        taper: taper.transpose()?,
        farthest_mm,
        pitch_mm,
    })
}
