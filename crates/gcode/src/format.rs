//! A program in canonical spacing: one way to write each block, and what lies inside an O-word's
//! pair moved in.
//!
//! ```text
//!   o100 SUB                 o100 sub
//!   g1x1.50 y[ #1 * 2 ](in)    G1 X1.5 Y[#1*2] (in)
//!   O100endsub               o100 endsub
//! ```
//!
//! What a line means never changes: each is printed from its block ([`Block`]'s `Display`). A line
//! that cannot be read stays as it was, byte for byte, and so does all that follows a tape's second
//! `%`. Line ends stay CR LF where the file's first line has them.

use crate::{Block, Grammar, Keyword, Label, Parser, fanuc::is_for_people, print::Printed};

/// Blanks a level is moved in by.
const STEP: usize = 2;
/// Levels that are moved in; what lies deeper stays there.
const DEEPEST: usize = 20;

/// The program anew. Formatting what was formatted changes nothing.
#[must_use]
pub fn format(source: &[u8], grammar: Grammar) -> Vec<u8> {
    let line_end: &[u8] = match memchr::memchr(b'\n', source) {
        Some(at) if at > 0 && source[at - 1] == b'\r' => b"\r\n",
        _ => b"\n",
    };
    let (mut parser, mut block) = (Parser::with_grammar(source, 0, grammar), Block::new());
    let mut out = Vec::with_capacity(source.len() + source.len() / 8);
    let mut open: Vec<(Keyword, String)> = Vec::new();
    let (mut tape, mut continues) = (0, false);
    while parser.next(&mut block) {
        if block.faulty {
            let line = line_of(source, &block);
            // behind another block of its line there is one blank already
            out.extend_from_slice(if continues { line.trim_ascii_start() } else { line });
        } else {
            let depth = depth(&block, &mut open).min(DEEPEST);
            let text = Printed { block: &block, source, grammar }.to_string();
            let text = with_head_as_written(&block, text, source);
            if !text.is_empty() {
                out.extend(std::iter::repeat_n(b' ', STEP * depth));
                out.extend_from_slice(text.trim_end().as_bytes());
            }
        }
        let end = block.span.end as usize;
        if grammar == Grammar::Fanuc && source.get(end) == Some(&b';') {
            out.push(b';');
            let behind = source[end + 1..].split(|byte| matches!(byte, b'\n' | b'\r')).next();
            let behind = behind.unwrap_or_default().trim_ascii_end();
            if is_for_people(behind) {
                out.extend_from_slice(behind);
            }
        }
        let (rest, line) = parser.position();
        if line == block.span.line && (rest as usize) < source.len() {
            out.push(b' '); // another block of this line
            continues = true;
            continue;
        }
        continues = false;
        out.extend_from_slice(line_end);
        tape += u8::from(block.percent);
        if tape == 2 {
            let rest = parser.position().0 as usize;
            out.extend_from_slice(source.get(rest..).unwrap_or_default());
            break;
        }
    }
    out
}

fn line_of<'a>(source: &'a [u8], block: &Block) -> &'a [u8] {
    source.get(block.span.start as usize..block.span.end as usize).unwrap_or_default()
}

/// O0012, :12 and <NAME> as they stand in the text: a machine lists programs by them. The letter is
/// a capital where a program begins, and small before a keyword (`o100 sub`).
fn with_head_as_written(block: &Block, text: String, source: &[u8]) -> String {
    let Some(o) = block.o else { return text };
    let head = source.get(o.span.start as usize..o.span.end as usize).unwrap_or_default();
    let first = head.first().map_or('O', |byte| char::from(*byte));
    let letter = match first {
        ':' | '<' => String::new(),
        _ if o.keyword == Keyword::Program => "O".to_owned(),
        _ => "o".to_owned(),
    };
    let (printed, written) = match o.label {
        Label::Number(number) => {
            let letter = if first == ':' { ":".to_owned() } else { letter };
            (format!("o{number}"), letter + &digits_as_written(number, head))
        }
        Label::Name(name) => {
            let name = block.text(name);
            (format!("o<{name}>"), format!("{letter}<{name}>"))
        }
        Label::Computed(_) => ("o".to_owned(), letter),
    };
    text.replacen(&printed, &written, 1)
}

/// The digits of a program's number with the zeros before it.
fn digits_as_written(number: u32, head: &[u8]) -> String {
    let digits = head.iter().skip(1).filter(|byte| !byte.is_ascii_whitespace());
    let digits: String =
        digits.take_while(|byte| byte.is_ascii_digit()).map(|b| char::from(*b)).collect();
    if digits.parse() == Ok(number) { digits } else { number.to_string() }
}

/// Levels this block is moved in by, and what is open after it.
fn depth(block: &Block, open: &mut Vec<(Keyword, String)>) -> usize {
    let Some(word) = block.o else { return open.len() };
    let label = match word.label {
        Label::Number(number) => number.to_string(),
        Label::Name(name) => block.text(name).to_owned(),
        Label::Computed(_) => return open.len(),
    };
    match word.keyword {
        Keyword::While if open.last().is_some_and(|o| *o == (Keyword::Do, label.clone())) => {
            open.pop();
            open.len()
        }
        Keyword::Sub | Keyword::If | Keyword::While | Keyword::Do | Keyword::Repeat => {
            open.push((word.keyword, label));
            open.len() - 1
        }
        Keyword::ElseIf | Keyword::Else => open.len().saturating_sub(1),
        Keyword::EndSub | Keyword::EndIf | Keyword::EndWhile | Keyword::EndRepeat => {
            open.pop();
            open.len()
        }
        _ => open.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::format;
    use crate::Grammar;

    fn formatted(text: &str) -> String {
        String::from_utf8(format(text.as_bytes(), Grammar::Rs274)).unwrap_or_default()
    }

    #[test]
    fn a_point_after_a_whole_number_stays_for_where_it_counts() {
        assert_eq!(formatted("g1x10. y5 z-3.0 f100.\n"), "G1 X10. Y5 Z-3. F100.\n");
    }

    #[test]
    fn a_fanuc_tape_is_read_as_one() {
        let text = "%\no1234(test)\nn10if[#1gt5]goto 20\nwhile[#1le3]do1\n/2g0x1.u5\nend1\ng65p9100a1.b2\n%\n";
        let wanted = "%\nO1234 (test)\nN10 IF[#1 GT 5]GOTO20\nWHILE[#1 LE 3]DO1\n/2 G0 X1. U5\nEND1\nG65 P9100 A1. B2\n%\n";
        let formatted = |text: &str| {
            String::from_utf8(format(text.as_bytes(), Grammar::Fanuc)).unwrap_or_default()
        };
        assert_eq!(formatted(text), wanted);
        assert_eq!(formatted(wanted), wanted);
    }

    #[test]
    fn blocks_of_one_line_stay_in_it_and_heads_as_they_are() {
        let text = "%\n<Part-A>(x);\nO0005 ;g0x1.;y2.;(a;b)\n:12\nm98<Sub>q10\ng1x1.,r2.\ndprnt[x#1[53]*y]\nn1/2m30;\n%";
        let wanted = "%\n<Part-A> (x);\nO0005; G0 X1.; Y2.; (a;b)\n:12\nM98 Q10 <Sub>\nG1 X1. ,R2.\nDPRNT[X#1[53]*Y]\n/2 N1 M30;\n%\n";
        let formatted = |text: &str| {
            String::from_utf8(format(text.as_bytes(), Grammar::Fanuc)).unwrap_or_default()
        };
        assert_eq!(formatted(text), wanted);
        assert_eq!(formatted(wanted), wanted);
    }

    #[test]
    fn blanks_and_case_become_one_way_to_write_it() {
        assert_eq!(formatted("n10g1x1.50 y[ #1 * 2 ](in)\n"), "N10 G1 X1.5 Y[#1*2] (in)\n");
    }

    #[test]
    fn a_programs_number_stays_as_it_is_and_an_o_word_is_small() {
        let text = "%\no1000(plate)\nm98p0012l2\nt0101\nm30\nO0012\nm99\nO007SUB\nO007 endsub\n%\n";
        let wanted =
            "%\nO1000 (plate)\nM98 P0012 L2\nT0101\nM30\nO0012\nM99\no007 sub\no007 endsub\n%\n";
        assert_eq!(formatted(text), wanted);
        assert_eq!(formatted(wanted), wanted);
    }

    #[test]
    fn brackets_stay_where_the_dialect_needs_them() {
        let fanuc = |text: &str| {
            String::from_utf8(format(text.as_bytes(), Grammar::Fanuc)).unwrap_or_default()
        };
        // of Fanuc's, AND binds like a product, OR like a sum; of LinuxCNC's both bind least of all
        let text = "#5=[#1+#2]AND#3\n#6=[#1EQ1]AND[#2EQ2]\n#7=[#1OR#2]EQ3\n";
        let wanted = "#5=[[#1+#2] AND #3]\n#6=[[#1 EQ 1] AND [#2 EQ 2]]\n#7=[#1 OR #2 EQ 3]\n";
        assert_eq!(fanuc(text), wanted);
        assert_eq!(fanuc(wanted), wanted);
        let text = "#5=[[#1+#2]AND#3]\n#6=[[#1EQ1]AND[#2EQ2]]\n#7=[[#1OR#2]EQ3]\n";
        let wanted = "#5=[#1+#2 AND #3]\n#6=[#1 EQ 1 AND #2 EQ 2]\n#7=[[#1 OR #2] EQ 3]\n";
        assert_eq!(formatted(text), wanted);
    }

    #[test]
    fn what_lies_inside_a_pair_is_moved_in() {
        let text = "o1 sub\no2 if [#1 gt 2]\nx1\no2 else\nx2\no2 endif\no3 do\nx3\no3 while [0]\no1 endsub\nM2\n";
        let wanted = "o1 sub\n  o2 if [#1 GT 2]\n    X1\n  o2 else\n    X2\n  o2 endif\n  o3 do\n    X3\n  o3 while [0]\no1 endsub\nM2\n";
        assert_eq!(formatted(text), wanted);
        assert_eq!(formatted(wanted), wanted);
    }

    #[test]
    fn a_line_that_cannot_be_read_stays_as_it_is() {
        assert_eq!(formatted("g1  x1 yy\n  hello?\n"), "g1  x1 yy\n  hello?\n");
    }

    #[test]
    fn comments_and_empty_lines_stay() {
        assert_eq!(
            formatted(";  head \n\n( a )\ng0 x0 ; end\n"),
            ";  head\n\n( a )\nG0 X0 ; end\n"
        );
    }

    #[test]
    fn line_ends_stay_those_of_the_file() {
        assert_eq!(formatted("g0x0\r\nm2\r\n"), "G0 X0\r\nM2\r\n");
    }

    #[test]
    fn what_follows_the_tape_stays() {
        assert_eq!(formatted("%\ng0x0\n%\nany thing  at all"), "%\nG0 X0\n%\nany thing  at all");
    }
}
