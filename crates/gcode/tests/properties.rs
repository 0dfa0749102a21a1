//! What holds for every text: reading never fails, and printing loses nothing.
use crate::common;
use gcode::{Block, Parser};
use proptest::prelude::*;

fn blocks(program: &[u8]) -> (Vec<Block>, Vec<diag::Diagnostic>) {
    let (mut parser, mut block) = (Parser::new(program, 0), Block::new());
    let mut blocks = Vec::new();
    while parser.next(&mut block) {
        blocks.push(block.clone());
    }
    (blocks, parser.take_diagnostics())
}

fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        (-99_999i64..99_999).prop_map(|n| n.to_string()),
        (-9_999i64..9_999, 0u32..99_999).prop_map(|(a, b)| format!("{a}.{b}")),
        any::<f64>().prop_filter("finite", |n| n.is_finite()).prop_map(|n| format!("{n}")),
        "[+-]?\\.[0-9]{1,20}",
    ]
}

fn value() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        number(),
        (1u32..5000).prop_map(|n| format!("#{n}")),
        "#<_?[a-zA-Z ]{0,4}[a-z_0-9]>",
        "exists\\[#<[a-z]{1,3}>\\]",
    ];
    leaf.prop_recursive(4, 24, 3, |inner| {
        let operator = prop::sample::select(vec![
            "**", "*", "/", "+", "-", " MOD ", " eq ", "NE", "gt", "GE", "lt", "LE", " and ", "or",
            " xor ",
        ]);
        let function = prop::sample::select(vec![
            "abs", "ACOS", "asin", "COS", "exp", "FIX", "fup", "LN", "round", "SIN", "sqrt", "tan",
        ]);
        let chain = (inner.clone(), prop::collection::vec((operator, inner.clone()), 0..4))
            .prop_map(|(first, rest)| {
                let rest: String = rest.into_iter().map(|(o, v)| format!("{o}{v}")).collect();
                format!("[{first}{rest}]")
            });
        prop_oneof![
            3 => chain.clone(),
            1 => inner.clone().prop_map(|v| format!("-{v}")),
            1 => chain.clone().prop_map(|v| format!("#{v}")),
            1 => (function, chain.clone()).prop_map(|(f, v)| format!("{f}{v}")),
            1 => (chain.clone(), chain).prop_map(|(y, x)| format!("atan{y}/{x}")),
        ]
    })
}

fn line() -> impl Strategy<Value = String> {
    let letters = prop::sample::subsequence(b"ABCDFHIJKPQRSXYZ@^$".to_vec(), 0..6);
    let words = (letters, prop::collection::vec(value(), 6)).prop_map(|(letters, values)| {
        let words = letters.iter().zip(values).map(|(l, v)| format!("{}{v} ", *l as char));
        words.collect::<String>()
    });
    let setting = (1u32..99, value()).prop_map(|(n, v)| format!("#{n}={v} "));
    let comment = "\\((MSG,|debug,|PY,|)[ a-z;#é]{0,6}\\)";
    let end = "(;[ a-z(),é]{0,8})?";
    let keyword = prop::sample::select(vec!["call", "return", "if", "while", "repeat", "endsub"]);
    let o_word =
        (value(), keyword, value()).prop_map(|(label, k, v)| format!("O[{label}] {k} [{v}]"));
    let start = "(/[0-9]?)?( N[0-9]{1,5}(\\.5)?)? ?";
    let body = prop_oneof![
        4 => (words, setting, comment).prop_map(|(w, s, c)| format!("{w}{s}{c}")),
        1 => o_word,
    ];
    (start, body, end).prop_map(|(start, body, end)| format!("{start}{body}{end}\n"))
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_a_panic(program in prop::collection::vec(any::<u8>(), 0..400)) {
        let (blocks, found) = blocks(&program);
        prop_assert!(found.len() <= blocks.len());
    }

    #[test]
    fn text_made_of_the_languages_own_pieces_is_read_without_a_panic(
        program in "([GXYNOo#<>\\[\\]()/;%=*+. \n0-9-]|sin|sub|while|MOD|exists|\u{e9}){0,60}"
    ) {
        let (blocks, _) = blocks(program.as_bytes());
        for block in blocks {
            let _ = block.to_string();
        }
    }

    #[test]
    fn a_printed_program_read_again_is_the_same(lines in prop::collection::vec(line(), 1..5)) {
        let program = lines.concat();
        let (first, found) = blocks(program.as_bytes());
        prop_assert_eq!(found, [], "in {:?}", program);
        let printed: String = first.iter().map(|b| format!("{b}\n")).collect();
        let (second, found) = blocks(printed.as_bytes());
        prop_assert_eq!(found, [], "in {:?}", printed);
        prop_assert_eq!(first.len(), second.len());
        for (a, b) in first.iter().zip(&second) {
            prop_assert_eq!(common::content(a), common::content(b));
            prop_assert_eq!(a.to_string(), b.to_string());
        }
    }

    #[test]
    fn a_number_read_by_hand_is_the_number_the_standard_library_reads(
        text in "-?[0-9]{1,12}\\.[0-9]{1,9}"
    ) {
        let (blocks, _) = blocks(format!("X{text}").as_bytes());
        let expected: f64 = text.parse().expect("a number");
        let gcode::Value::Number(number) = blocks[0].words[0].value else { panic!("a number") };
        prop_assert_eq!(number.to_bits(), expected.to_bits());
    }

    #[test]
    fn every_span_lies_in_its_line(program in "([GXY#\\[\\] ()0-9.=\n-]|sin|é){0,60}") {
        let (blocks, found) = blocks(program.as_bytes());
        for block in &blocks {
            for word in &block.words {
                prop_assert!(word.span.start >= block.span.start && word.span.end <= block.span.end);
            }
        }
        for d in found {
            prop_assert!(d.span.start <= d.span.end && d.span.end as usize <= program.len());
        }
    }
}
