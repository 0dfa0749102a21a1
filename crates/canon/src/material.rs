//! What is cut, by name. What it withstands says who needs it: the machine's file for the plant,
//! the judge by a table of its own.

/// A material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Material {
    /// C45, 1.0503.
    CarbonSteel,
    /// 42CrMo4, 1.7225.
    AlloySteel,
    /// Austenitic stainless steel.
    Stainless,
    /// Grey cast iron GG25.
    CastIron,
    /// `AlSi`.
    Aluminium,
    /// Free-cutting brass.
    Brass,
}

impl Material {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::CarbonSteel,
        Self::AlloySteel,
        Self::Stainless,
        Self::CastIron,
        Self::Aluminium,
        Self::Brass,
    ];

    /// Its name in files, options and certificates.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CarbonSteel => "C45",
            Self::AlloySteel => "42CrMo4",
            Self::Stainless => "stainless",
            Self::CastIron => "GG25",
            Self::Aluminium => "AlSi",
            Self::Brass => "brass",
        }
    }

    /// The material of that name, in any case of letters.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|material| material.name().eq_ignore_ascii_case(name))
    }
}
