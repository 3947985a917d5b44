//! Materials and the speed at which their threads are cut. Out: m/min, for a coated carbide insert.
//!
//! The ranges are those that a maker of inserts prints for threading with its general grade (Iscar,
//! *Holders and inserts for threading*, 2022, "Machining data for threading", grade IC908). A recipe begins
//! at their lower end: what is known of the machine, the clamping and the bar decides what is more.

/// A group of materials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Material {
    /// Unalloyed steel up to 0.55 % carbon, 650 N/mm².
    #[default]
    Steel,
    /// Low-alloy steel, quenched and tempered, 930 to 1000 N/mm².
    AlloySteel,
    /// Austenitic and duplex stainless steel.
    Stainless,
    /// Grey cast iron.
    CastIron,
    /// Nodular cast iron.
    Nodular,
    /// Wrought aluminium alloys that harden.
    Aluminium,
    /// Brass and copper.
    Brass,
}

impl Material {
    /// All of them.
    pub const ALL: [Material; 7] = [
        Material::Steel,
        Material::AlloySteel,
        Material::Stainless,
        Material::CastIron,
        Material::Nodular,
        Material::Aluminium,
        Material::Brass,
    ];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Material::Steel => "steel",
            Material::AlloySteel => "alloy-steel",
            Material::Stainless => "stainless",
            Material::CastIron => "cast-iron",
            Material::Nodular => "nodular",
            Material::Aluminium => "aluminium",
            Material::Brass => "brass",
        }
    }

    /// What it stands for, for people.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Material::Steel => "unalloyed steel up to 0.55 % carbon",
            Material::AlloySteel => "low-alloy steel, quenched and tempered",
            Material::Stainless => "austenitic and duplex stainless steel",
            Material::CastIron => "grey cast iron",
            Material::Nodular => "nodular cast iron",
            Material::Aluminium => "wrought aluminium alloys",
            Material::Brass => "brass and copper",
        }
    }

    /// Lowest and highest speed that is recommended, m/min.
    #[must_use]
    pub fn speeds_m_min(self) -> [f64; 2] {
        match self {
            Material::Steel => [110.0, 180.0],
            Material::AlloySteel => [70.0, 140.0],
            Material::Stainless => [90.0, 140.0],
            Material::CastIron => [90.0, 160.0],
            Material::Nodular => [60.0, 130.0],
            Material::Aluminium => [80.0, 220.0],
            Material::Brass => [80.0, 255.0],
        }
    }

    /// k_c1, N/mm², and m_c of Kienzle's law, for a rake of 0 (Iscar, turning catalogue 2017, page 558:
    /// groups 2, 8, 14, 18, 16, 22, 27).
    pub(crate) fn kienzle(self) -> [f64; 2] {
        match self {
            Material::Steel => [1500.0, 0.22],
            Material::AlloySteel => [1725.0, 0.24],
            Material::Stainless => [2150.0, 0.20],
            Material::CastIron | Material::Nodular => [1350.0, 0.28],
            Material::Aluminium => [800.0, 0.25],
            Material::Brass => [700.0, 0.27],
        }
    }

    /// Spindle speed of its lowest speed at a diameter, 1/min.
    #[must_use]
    pub(crate) fn rpm(self, diameter_mm: f64) -> f64 {
        1000.0 * self.speeds_m_min()[0] / (std::f64::consts::PI * diameter_mm)
    }
}
