//! DPRNT and BPRNT: what a macro writes to the control's external device, said as text.
//!
//! `DPRNT[X#1[53]]` writes `X12.345`: the decimals as told, no zeros or blanks before the number
//! (parameter PRT = 1). `BPRNT[#1[3]]` writes four bytes; here they are eight hexadecimal digits.
//!
//! Source: Fanuc, operator's manual of series 30i, "External output commands".
use crate::{
    call::{Call, Sink, out::Out},
    fault::Outcome,
    front_end::fanuc::{state::Fanuc, variables::values::values},
    program::Program,
};
use gcode::{Output, Piece};
use std::fmt::Write;

pub(crate) fn output<S: Sink>(fanuc: &Fanuc, it: &Program<'_>, out: &mut Out<'_, S>) -> Outcome {
    let binary = match it.block.output {
        Some(Output::Decimal) => false,
        Some(Output::Binary) => true,
        Some(Output::Open | Output::Close) | None => return Ok(()), // the device is always there
    };
    let mut text = String::new();
    for piece in &it.block.pieces {
        match *piece {
            Piece::Text(words) => text.push_str(it.block.text(words)),
            Piece::Value { value, decimals, .. } => {
                let values = values(fanuc, &it.executor);
                let value = values.value(&it.block, value, it.block.span)?.unwrap_or(0.0);
                let places = usize::from(decimals);
                let done = if binary {
                    let scaled = (value * 10_f64.powi(i32::from(decimals))).round();
                    write!(text, "{:08X}", scaled as i32)
                } else {
                    let power = 10_f64.powi(i32::from(decimals));
                    write!(text, "{:.places$}", (value * power).round() / power)
                };
                let _ = done; // a String takes everything
            }
        }
    }
    out.say(&Call::Print(&text));
    Ok(())
}
