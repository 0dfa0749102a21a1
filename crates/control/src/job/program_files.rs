//! Which files are programs: by their name and by what is in them. Whatever else lies in a folder
//! of programs (keys, tokens, what a control keeps) is none, and is neither shown nor read as one.
use std::path::Path;

/// Endings of files that are programs.
pub const ENDINGS: [&str; 8] = ["ngc", "nc", "tap", "gcode", "cnc", "mpf", "eia", "gc"];
/// Bytes in which keys and tokens are looked for: their files are short.
const HEAD: usize = 64 << 10;
/// What a line of a key or a certificate, of a file of tokens, and of what a control keeps begins
/// with.
const FOREIGN: [(&str, &str); 3] = [
    ("-----BEGIN ", "it has a key or a certificate"),
    ("[[token]]", "it is a file of tokens"),
    ("# leadscrew ", "it is a file that a control keeps"),
];

/// Whether a file has the name of a program: one of the [`ENDINGS`], or as controls give them,
/// `O1234` with no ending or `.txt`.
pub fn has_name_of_one(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("");
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known))
        || (ending.is_empty() || ending.eq_ignore_ascii_case("txt"))
            && stem.strip_prefix(['O', 'o']).is_some_and(is_number)
}

/// What the names of programs are, for a sentence.
pub fn names() -> String {
    format!("a program's name ends in .{}, or is O and a number, as in O1234", ENDINGS.join(", ."))
}

/// Whether bytes are the text of a program.
///
/// # Errors
/// They are not, and what they are.
pub fn check_text(text: &[u8]) -> Result<(), &'static str> {
    if text.contains(&0) {
        return Err("it is no text");
    }
    if is_blank(text) {
        return Err("it is empty");
    }
    not_foreign(text)
}

/// Byte order marks of UTF-8 and UTF-16.
const MARKS: [&[u8]; 3] = [b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"];

/// A text without its byte order mark.
fn without_mark(text: &[u8]) -> &[u8] {
    MARKS.iter().find_map(|mark| text.strip_prefix(*mark)).unwrap_or(text)
}

/// Whether nothing of a text could be seen: white space, control characters, byte order marks.
fn is_blank(text: &[u8]) -> bool {
    let is_invisible = |char: char| {
        let is_mark = matches!(char, '\u{feff}' | '\u{200b}'..='\u{200f}' | '\u{2060}');
        is_mark || char.is_whitespace() || char.is_control()
    };
    String::from_utf8_lossy(without_mark(text)).chars().all(is_invisible)
}

/// The same of a text that may be empty.
///
/// # Errors
/// It has a secret in it, or what a control keeps.
pub fn not_foreign(text: &[u8]) -> Result<(), &'static str> {
    let text = without_mark(text);
    let head = &text[..text.len().min(HEAD)];
    let is_in = |what: &str| {
        head.split(|byte| matches!(byte, b'\n' | b'\r'))
            .any(|line| line.trim_ascii_start().starts_with(what.as_bytes()))
    };
    FOREIGN.iter().find(|(what, _)| is_in(what)).map_or(Ok(()), |(_, reason)| Err(*reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_tokens_and_what_is_kept_have_no_name_of_a_program() {
        for none in [
            "key.pem",
            "tokens.toml",
            "parameters.var",
            "lock",
            "mqtt-login",
            "tools.tbl",
            ".ngc",
            "ngc",
            "id_rsa",
            "O",
            "O12a",
            "a.ngc.previous",
            "a.ngc~",
            "a.txt",
        ] {
            assert!(!has_name_of_one(Path::new(none)), "{none}");
        }
        for program in
            ["a.ngc", "PART.NC", "O0001", "o7", "a.b.tap", "folder/x.mpf", "a.gc", "O12.txt"]
        {
            assert!(has_name_of_one(Path::new(program)), "{program}");
        }
    }

    #[test]
    fn what_is_no_text_of_a_program_is_none_whatever_its_name() {
        for none in [
            "",
            " \r\n",
            "\u{feff}",
            "\u{feff} \r\n\t\u{feff}",
            "\u{a0}\u{200b}\n",
            "\u{b}\u{c}\u{1a}",
            "\u{feff}-----BEGIN PRIVATE KEY-----\nMII",
            "\u{feff}# leadscrew tools 1, checksum 5d0c01b2\n",
            "G0 X1\0",
            "-----BEGIN PRIVATE KEY-----\nMII",
            "; a note\n  -----BEGIN CERTIFICATE-----",
            "[[token]]\nname = \"a\"",
            "# leadscrew tools 1, checksum 5d0c01b2\n",
        ] {
            assert!(check_text(none.as_bytes()).is_err(), "{none:?}");
        }
        for program in ["M30", "%\nO0001 (PART)\nM30\n%", "(\u{e4})\nG0 X1", "o<-----BEGIN> sub"] {
            assert_eq!(check_text(program.as_bytes()), Ok(()), "{program:?}");
        }
        assert_eq!(check_text(b"(\xe4)\r\nM2\r\n"), Ok(()), "of another code page");
        assert_eq!(check_text("\u{feff}M2\r\n".as_bytes()), Ok(()), "with a byte order mark");
        for mark in MARKS {
            assert_eq!(check_text(mark), Err("it is empty"), "{mark:?}");
            assert!(not_foreign(&[mark, b"[[token]]"].concat()).is_err(), "{mark:?}");
        }
    }
}
