//! The texts that a program executes, and by what it is known again that none of them was changed.
//!
//! ```text
//!   part.ngc ──calls──► holes.ngc ──calls──► peck.ngc      one hash of the three
//! ```
//!
//! A hole or a line is found in what all of them make together: an edited macro moves the holes of
//! a program whose own text is as it was. Tools, offsets and cams are no text. Nor is the name of
//! the program: the same texts under another one are the same.
use crate::job::Session;
use crate::job::drawn::Drawn;

/// The texts of a program.
#[derive(Clone, Copy, Debug)]
pub struct Texts<'a> {
    /// The program's own.
    pub own: &'a [u8],
    /// Those of the files that it draws in.
    pub drawn: &'a [Drawn],
}

impl Session {
    /// All texts that a program with this text executes.
    pub fn texts<'a>(&'a self, own: &'a [u8]) -> Texts<'a> {
        Texts { own, drawn: &self.drawn }
    }
}

impl Texts<'_> {
    /// SHA-256 of all of them; of a program that draws in no file it is that of its text.
    pub fn sha256(&self) -> String {
        if self.drawn.is_empty() {
            return store::certificate::sha256(self.own);
        }
        store::certificate::sha256(&self.listed(store::certificate::sha256))
    }

    /// CRC-32 of all of them; of a program that draws in no file it is that of its text.
    pub fn crc32(&self) -> u32 {
        if self.drawn.is_empty() {
            return crc32fast::hash(self.own);
        }
        crc32fast::hash(&self.listed(|text| crc32fast::hash(text).to_string()))
    }

    /// What may have been changed where a hash is another one: the program of this name, and what
    /// it calls.
    pub fn described(&self, name: &str) -> String {
        if self.drawn.is_empty() {
            name.to_owned()
        } else {
            format!("{name} or a file that it calls")
        }
    }

    /// A line a text, with its hash: the program's, then those that are called, by their names.
    fn listed(&self, hash: impl Fn(&[u8]) -> String) -> Vec<u8> {
        let mut called: Vec<_> = self.drawn.iter().map(|drawn| &drawn.sub).collect();
        called.sort_by(|a, b| a.name.cmp(&b.name));
        let called = called.iter().map(|sub| format!("{} {}\n", hash(&sub.source), sub.name));
        core::iter::once(format!("{}\n", hash(self.own))).chain(called).collect::<String>().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(name: &str, source: &str) -> Drawn {
        let sub = interp::Subprogram { name: name.into(), source: source.into() };
        Drawn { path: format!("{name}.ngc"), sub }
    }

    #[test]
    fn a_change_of_any_text_is_another_hash_and_their_order_and_places_are_none() {
        let [a, b] = [drawn("a", "G0 X1\n"), drawn("b", "G0 X2\n")];
        let marks = |own: &[u8], drawn: &[Drawn]| {
            let texts = Texts { own, drawn };
            (texts.sha256(), texts.crc32())
        };
        let own: &[u8] = b"o<a> call\nM2\n";
        let whole = marks(own, &[a.clone(), b.clone()]);
        let moved = Drawn { path: "elsewhere/a.ngc".into(), ..a.clone() };
        assert_eq!(marks(own, &[b.clone(), moved]), whole);
        for (own, drawn) in [
            (own, vec![a.clone()]),
            (own, vec![]),
            (b"o<a> call\n\nM2\n", vec![a.clone(), b.clone()]),
            (own, vec![a.clone(), drawn("b", "G0 X3\n")]),
            (own, vec![drawn("a", "G0 X2\n"), drawn("b", "G0 X1\n")]),
            (own, vec![a.clone(), drawn("c", "G0 X2\n")]),
        ] {
            let other = marks(own, &drawn);
            assert!(other.0 != whole.0 && other.1 != whole.1, "{drawn:?}");
        }
        assert_eq!(marks(own, &[]).0, store::certificate::sha256(own));
        assert_eq!(marks(own, &[]).1, crc32fast::hash(own));
    }
}
