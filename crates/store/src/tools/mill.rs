//! What tables and comments say of an end mill: its form, teeth, body and limits.
//!
//! | comment has | form |
//! |---|---|
//! | "ball", "ballnose", "ball-nose", "ballmill", "ballendmill" | ball |
//! | "bull", "bullnose", "bull-nose" | bull, if the radius of its corner is stated |
//! | "chamfer", "v", "v-bit", "vbit", "engraving" | conical, if its angle is stated in degrees |
//! | "thread", "taper", "tapered", "dovetail", "lollipop", "t-slot", "keyseat", "form", "slitting" | not known |
//! | "flat", "face", "facemill", "square", "endmill", "end-mill", "end mill" | flat |
//! | none of these | not known |
use super::table::optional_length;
use super::write::{degrees, number};
use crate::keys::Keys;
use canon::{CutterMaterial, Mill, MillForm, MillLimits};
use units::{Angle, Length};

/// Most teeth of a mill.
const MOST_TEETH: u32 = 200;
/// Longest length of a mill, mm.
const LONGEST_MM: f64 = 1000.0;

#[derive(Clone, Copy)]
enum FormName {
    Flat,
    Bull,
    Ball,
    Conical,
    Other,
}

/// Whatever a table in TOML states; flat unless it says otherwise.
pub(super) fn read(keys: &mut Keys<'_>) -> Mill {
    let forms = [
        ("flat", FormName::Flat),
        ("bull", FormName::Bull),
        ("ball", FormName::Ball),
        ("conical", FormName::Conical),
        ("other", FormName::Other),
    ];
    let materials = [("carbide", CutterMaterial::Carbide), ("hss", CutterMaterial::HighSpeedSteel)];
    let form = match keys.optional_choice("form", &forms).unwrap_or(FormName::Flat) {
        FormName::Flat => Some(MillForm::FLAT),
        FormName::Ball => Some(MillForm::Ball),
        FormName::Other => None,
        FormName::Bull => {
            let corner = stated(keys, ["corner_radius_mm", "corner_radius_in"], 0.0);
            if corner.is_none() {
                keys.conflict("form", "a bull-nose mill: expected its `corner_radius_mm`");
            }
            corner.map(|corner| MillForm::Cylindrical { corner })
        }
        FormName::Conical => {
            let angle = keys.number("point_angle_deg", 1.0..=179.0);
            let tip = stated(keys, ["tip_diameter_mm", "tip_diameter_in"], 0.0);
            let tip = tip.unwrap_or(Length::ZERO);
            Some(MillForm::Conical { angle: Angle::deg(angle), tip })
        }
    };
    Mill {
        form,
        teeth: keys.optional_whole("teeth", 1..=MOST_TEETH),
        body: keys.optional_choice("body_material", &materials),
        limits: MillLimits {
            chip: stated(keys, ["max_chip_mm", "max_chip_in"], 1e-4),
            depth: stated(keys, ["max_depth_mm", "max_depth_in"], 1e-3),
            deflection: stated(keys, ["max_deflection_mm", "max_deflection_in"], 1e-4),
        },
    }
}

fn stated(keys: &mut Keys<'_>, names: [&'static str; 2], least_mm: f64) -> Option<Length> {
    optional_length(keys, names, least_mm..=LONGEST_MM)
}

/// Keys and values that read back as this mill.
pub(super) fn written(mill: &Mill) -> Vec<(&'static str, String)> {
    let mut all = Vec::new();
    let mut form = |name: &str| all.push(("form", format!("\"{name}\"")));
    match mill.form {
        None => form("other"),
        Some(MillForm::Ball) => form("ball"),
        Some(MillForm::Cylindrical { corner }) if corner == Length::ZERO => form("flat"),
        Some(MillForm::Cylindrical { corner }) => {
            form("bull");
            all.push(("corner_radius_mm", number(corner.value())));
        }
        Some(MillForm::Conical { angle, tip }) => {
            form("conical");
            all.push(("point_angle_deg", degrees(angle)));
            all.push(("tip_diameter_mm", number(tip.value())));
        }
    }
    all.extend(mill.teeth.map(|teeth| ("teeth", teeth.to_string())));
    all.extend(mill.body.map(|body| {
        let name = match body {
            CutterMaterial::Carbide => "\"carbide\"",
            CutterMaterial::HighSpeedSteel => "\"hss\"",
        };
        ("body_material", name.to_owned())
    }));
    let MillLimits { chip, depth, deflection } = mill.limits;
    let limits =
        [("max_chip_mm", chip), ("max_depth_mm", depth), ("max_deflection_mm", deflection)];
    all.extend(limits.into_iter().filter_map(|(key, most)| Some((key, number(most?.value())))));
    all
}

/// What the words of a comment, in lower case, say of an end mill; lengths are in `unit` mm.
pub fn of_words<W: AsRef<str>>(words: &[W], unit: f64) -> Mill {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    let has = |wanted: &[&str]| words.iter().any(|word| wanted.contains(word));
    let followed = |first: &str, second: &str| words.windows(2).any(|w| w == [first, second]);
    let form = if has(&["ball", "ballnose", "ball-nose", "ballmill", "ballendmill"]) {
        Some(MillForm::Ball)
    } else if has(&["bull", "bullnose", "bull-nose"]) {
        corner(&words, unit).map(|corner| MillForm::Cylindrical { corner })
    } else if has(&["chamfer", "v", "v-bit", "vbit", "engraving"]) {
        cone(&words).map(|angle| MillForm::Conical { angle, tip: Length::ZERO })
    } else if has(&UNUSUAL) || words.iter().any(|word| word.starts_with("taper")) {
        None
    } else if has(&["flat", "face", "facemill", "square", "endmill", "end-mill"])
        || followed("end", "mill")
    {
        let corner = corner(&words, unit).unwrap_or(Length::ZERO);
        Some(MillForm::Cylindrical { corner })
    } else {
        None
    };
    Mill { form, teeth: teeth(&words), ..Mill::default() }
}

/// Mills that leave another form than these.
const UNUSUAL: [&str; 9] = [
    "thread",
    "thread-mill",
    "dovetail",
    "lollipop",
    "t-slot",
    "keyseat",
    "form",
    "slitting",
    "woodruff",
];

/// Behind "cr": the radius of a corner, in the post's unit.
fn corner(words: &[&str], unit: f64) -> Option<Length> {
    let at = words.iter().position(|word| *word == "cr")?;
    let value = plain(words.get(at + 1)?)?;
    (0.0..=LONGEST_MM).contains(&(value * unit)).then(|| Length::mm(value * unit))
}

/// The full angle of a cone: as stated in degrees, and behind "taper" half of it.
fn cone(words: &[&str]) -> Option<Angle> {
    let number = |at: usize| {
        let word = words.get(at)?;
        let cut = ["degrees", "deg", "°"].iter().find_map(|unit| word.strip_suffix(unit));
        let apart = words.get(at + 1).is_some_and(|next| next.starts_with("deg"));
        plain(cut.or_else(|| apart.then_some(*word))?)
    };
    let half = words.iter().position(|word| *word == "taper").and_then(|at| number(at + 1));
    let full = half.map(|half| 2.0 * half).or_else(|| (0..words.len()).find_map(number))?;
    (1.0..=179.0).contains(&full).then(|| Angle::deg(full))
}

/// "3fl", "3flute", "3 flutes", "2 teeth".
fn teeth(words: &[&str]) -> Option<u32> {
    const UNITS: [&str; 5] = ["flutes", "flute", "fl", "teeth", "tooth"];
    let joined = words.iter().filter_map(|w| UNITS.iter().find_map(|unit| w.strip_suffix(unit)));
    let apart = words.windows(2).filter(|w| UNITS.contains(&w[1])).map(|w| w[0]);
    let number = joined.chain(apart).find_map(|word| word.trim_end_matches('-').parse().ok())?;
    (1..=MOST_TEETH).contains(&number).then_some(number)
}

fn plain(word: &str) -> Option<f64> {
    word.trim_end_matches('.').parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Mill {
        of_words(&text.split_whitespace().collect::<Vec<_>>(), 1.0)
    }

    #[test]
    fn a_comment_says_the_form_and_the_teeth() {
        let bull = MillForm::Cylindrical { corner: Length::mm(0.5) };
        let cone = |deg| MillForm::Conical { angle: Angle::deg(deg), tip: Length::ZERO };
        for (text, form) in [
            ("d 6. cr 0. zmin -12. flat end mill", Some(MillForm::FLAT)),
            ("1/4 end mill", Some(MillForm::FLAT)),
            ("d 50. cr 0. face mill", Some(MillForm::FLAT)),
            ("d 8. cr 4. ball end mill", Some(MillForm::Ball)),
            ("d 8. cr .5 bull nose end mill", Some(bull)),
            ("bull nose end mill", None),
            ("d 10. cr 0. taper 45deg chamfer mill", Some(cone(90.0))),
            ("90 deg chamfer mill", Some(cone(90.0))),
            ("chamfer mill", None),
            ("thread mill m8", None),
            ("tapered end mill", None),
            ("mill", None),
        ] {
            assert_eq!(of(text).form, form, "{text}");
        }
        assert_eq!(of("1/8 3flute endmill").teeth, Some(3));
        assert_eq!(of("5fl garr endmill").teeth, Some(5));
        assert_eq!(of("2 flute flat").teeth, Some(2));
        assert_eq!(of("flat end mill").teeth, None);
    }

    #[test]
    fn a_corner_of_a_post_in_inches_is_converted() {
        let words = ["cr", "0.02", "bull"];
        let form = of_words(&words, 25.4).form;
        assert_eq!(form, Some(MillForm::Cylindrical { corner: Length::mm(0.02 * 25.4) }));
    }
}
