//! What is known of a pass before it is cut: its line, its tool, where the stock lies. In: machine code, the
//! part if somebody said what it is, else the truth of the machine file if it says where the stock lies, else
//! zero of the program. Out: a [`Planned`] for each pass; mm of the machine.

use std::collections::BTreeMap;
use std::sync::Arc;

use machine::{Machine, Part};
use protocol::{Code, Item, ThreadPass};

/// Where the material is.
#[derive(Clone, Debug)]
pub(super) enum Stock {
    /// Between two places along Z, whatever X is.
    Ends([f64; 2]),
    /// Nobody has said where: below zero of the program, which lies here along Z, whatever X is.
    Below(f64),
    /// A part whose zero lies here on the machine: X, Z.
    Part(Arc<Part>, [f64; 2]),
}

impl Stock {
    /// Whether a tool at a point, whose edge reaches so far to either side along Z, is where material is; mm.
    pub(super) fn holds(&self, x: f64, z: f64, edge_mm: f64) -> bool {
        let nearest = |z: f64, [low, high]: [f64; 2]| {
            let nearest = z.clamp(low, high);
            ((z - nearest).abs() <= edge_mm).then_some(nearest)
        };
        match self {
            Stock::Ends(ends) => nearest(z, *ends).is_some(),
            Stock::Below(zero) => nearest(z, [f64::NEG_INFINITY, *zero]).is_some(),
            Stock::Part(part, origin) => {
                let z = nearest(z - origin[1], part.ends_mm());
                z.is_some_and(|z| part.holds(x - origin[0], z))
            }
        }
    }
}

/// A pass of the program.
#[derive(Clone, Debug)]
pub(super) struct Planned {
    /// Line of the program.
    pub(super) line: u32,
    /// The pass.
    pub(super) pass: ThreadPass,
    /// Number of the tool; 0 if none was selected.
    pub(super) tool: u32,
    /// Where the material is.
    pub(super) stock: Stock,
    /// Where zero of the program lies on the machine, if somebody said so: X, Z.
    pub(super) origin_mm: Option<[f64; 2]>,
    /// How deep it goes below the crest; 0 if the program does not say where that is.
    pub(super) depth_mm: f64,
}

/// Every pass of a program by its number; `tool` is the one before it, then the last one. A pass that no
/// regulator would accept is not expected.
pub(super) fn planned(machine: &Machine, items: &[Item], tool: &mut u32) -> BTreeMap<u32, Planned> {
    let said = sim_plant::stock_mm(machine).ok().flatten();
    let mut passes = BTreeMap::new();
    for Item { line, code } in items {
        match code {
            Code::Tool { number } => *tool = *number,
            Code::Pass(pass) if pass.check().is_ok() => {
                let stock = said.map_or(Stock::Below(0.0), Stock::Ends);
                let depth_mm = pass.depth_mm;
                let planned =
                    Planned { line: *line, pass: *pass, tool: *tool, stock, origin_mm: None, depth_mm };
                passes.insert(pass.pass, planned);
            }
            _ => {}
        }
    }
    passes
}

/// Says where zero of the program lies on the machine in each pass, X and Z, and what the part is if that is
/// known.
pub(super) fn lie_at(
    passes: &mut BTreeMap<u32, Planned>,
    origins_mm: &BTreeMap<u32, [f64; 2]>,
    part: Option<&Part>,
) {
    let part = part.cloned().map(Arc::new);
    for (number, origin) in origins_mm {
        let Some(planned) = passes.get_mut(number) else { continue };
        planned.origin_mm = Some(*origin);
        match (&part, &mut planned.stock) {
            (Some(part), stock) => *stock = Stock::Part(Arc::clone(part), *origin),
            (None, Stock::Below(zero)) => *zero = origin[1],
            (None, _) => {}
        }
    }
}
