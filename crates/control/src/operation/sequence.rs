//! A tool change by a sequence: recorded step by step, known half way, and led on from there.
//!
//! ```text
//!   kernel at a mark ─► stage and magazine change ─► on the disk ─► the kernel goes on
//!
//!   stop, alarm, reset, power cut in a step ─► half way: no program, no blocks, no jog, no homing
//!        │
//!        ├─ go on, undo       what inputs do not say is made so first, each with its proof
//!        ├─ step, step back   the same, one step alone
//!        └─ done by hand      the operator has brought it to rest and says which tool is in the spindle
//! ```
//!
//! The record names the step that was begun last, never more: what became of it, inputs say. Where
//! an axis is not where the step needs it, nothing moves by itself.
use super::changer::Changer;
use super::control::Control;
use super::request::{Accepted, Refusal, Request, SequenceOrder};
use super::writer::Key;
use crate::services::sequence::ReachedMark;
use canon::{Magazine, Resume, Sequence, SequenceStage, ToolChange};
use kernel::Order;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use store::state::{ChangerRecord, HalfWay};

/// How far an axis may be from where a step needs it, mm.
const OFF_MM: f64 = 0.5;

/// A tool change that is under way or was left half way.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct SequenceStatus {
    /// Its name.
    pub name: String,
    /// Name of the step that was begun last.
    pub step: String,
    /// Its number, from 1.
    pub number: u32,
    /// Number of steps of the sequence.
    pub of: u32,
    /// It is, or was, being undone.
    pub is_back: bool,
    /// Nothing leads it on: that is for the operator.
    pub is_half_way: bool,
    /// Only a person undoes this step.
    pub is_undone_by_hand: bool,
    /// Tool in the spindle at its beginning; 0 is none.
    pub from: u32,
    /// Tool in the spindle at its end; 0 is none.
    pub to: u32,
    /// What the step tells the operator to do.
    pub operator: Option<String>,
    /// Inputs as they are, and as they should be once the step is done.
    pub inputs: Vec<SequenceInput>,
}

/// An input that a sequence looks at.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct SequenceInput {
    /// Its name.
    pub name: String,
    /// It is on.
    pub is: bool,
    /// It should be on.
    pub should_be: bool,
}

/// Where the tools are.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct MagazineStatus {
    /// Tool in each pocket, pocket 1 first; 0 is none.
    pub pockets: Vec<u32>,
    /// Tool in the spindle; 0 is none.
    pub spindle: u32,
    /// Pocket at the spindle; `None`: not known.
    pub at: Option<u32>,
}

impl Control {
    /// Where the tools are, as it was kept; else as the tool table has them.
    pub(super) fn take_changer(&mut self, kept: Option<ChangerRecord>) {
        let machine = &self.base.machine;
        let Some(sequence) = machine.tool_change_sequence.clone() else { return };
        let Some(mut magazine) = crate::config::magazine(machine, &self.data.tools) else { return };
        let mut stage = None;
        if let Some(kept) = kept.filter(|kept| kept.pockets.len() == magazine.pockets.len()) {
            let ChangerRecord { pockets, spindle, home, at, half_way } = kept;
            magazine = Magazine { pockets, spindle, home, at: (at != 0).then_some(at) };
            if let Some(left) = half_way {
                stage = stage_of(&sequence, &left);
                self.events.notice(match stage {
                    Some(_) => format!(
                        "{} was left in its step \"{}\": sequence says how it is; go on, undo, step, or done by hand",
                        left.sequence, left.step
                    ),
                    None => format!(
                        "{} was left in its step \"{}\", which the machine's file does not have any more: bring it to rest by hand, then say sequence done TOOL",
                        left.sequence, left.step
                    ),
                });
                stage = stage.or_else(|| {
                    Some(SequenceStage { step: 0, back: false, change: change_of(&left) })
                });
            }
        }
        if let Some(simulation) =
            self.executor.machine.here().and_then(crate::Drives::simulation_mut)
        {
            let Magazine { pockets, spindle, at, .. } = &magazine;
            simulation.machine_mut().load_carousel(pockets, *spindle, *at);
        }
        self.changer = Some(Changer { sequence, magazine, stage, written: None });
    }

    /// A tool change was begun, is not over, and nothing leads it on.
    pub(super) fn half_way(&self) -> Option<SequenceStage> {
        self.changer.as_ref().and_then(|changer| changer.stage).filter(|_| self.under_way.is_none())
    }

    /// The kernel waits at a mark until it is on the disk.
    pub(super) fn follow_sequence(&mut self) {
        if self.changer.is_none() {
            return;
        }
        while let Some(ReachedMark { mark, .. }) =
            self.under_way.as_mut().and_then(|under_way| under_way.running.next_mark())
        {
            let Some(changer) = &mut self.changer else { return };
            (changer.magazine, changer.stage) = (mark.magazine, mark.stage);
            if let Err(why) = self.keep_changer() {
                self.events.notice(format!("the tool change does not go on: {why}"));
                self.executor.kernel.order(Order::Abort);
                return;
            }
            let written = Arc::new(AtomicBool::new(false));
            match self.kept.last() {
                None => written.store(true, Ordering::Release),
                Some(ticket) => {
                    let flag = Arc::clone(&written);
                    self.kept.when_written(ticket, move |result| {
                        flag.store(result.is_ok(), Ordering::Release);
                    });
                }
            }
            if let Some(changer) = &mut self.changer {
                changer.written = Some(written);
            }
        }
        let Some(changer) = &mut self.changer else { return };
        let is_written = |flag: &mut Arc<AtomicBool>| flag.load(Ordering::Acquire);
        if changer.written.take_if(is_written).is_some() {
            self.executor.kernel.answer();
        }
    }

    fn keep_changer(&mut self) -> Result<(), Refusal> {
        let Some(changer) = &self.changer else { return Ok(()) };
        let Magazine { pockets, spindle, home, at } = changer.magazine.clone();
        let half_way = changer.stage.map(|stage| HalfWay {
            sequence: changer.sequence.name.clone(),
            step: changer
                .sequence
                .steps
                .get(stage.step)
                .map_or_else(String::new, |s| s.name.clone()),
            back: stage.back,
            from: stage.change.from,
            returns_to: stage.change.returns_to,
            to: stage.change.to,
            fetched_from: stage.change.fetched_from,
        });
        let record = ChangerRecord { pockets, spindle, home, at: at.unwrap_or(0), half_way };
        self.kept.save(Key::Changer, move |folder| folder.save_changer(&record))
    }

    /// Where the tools are for what is planned now; `None`: no sequence works the changer.
    pub(super) fn planned_magazine(&self) -> Option<Magazine> {
        self.changer.as_ref().map(|changer| changer.magazine.clone())
    }

    /// Text and way of an order that leads a tool change on.
    pub(super) fn resumed(&self, order: SequenceOrder) -> Result<(String, Resume), Refusal> {
        let (Some(stage), Some(changer)) = (self.half_way(), &self.changer) else {
            return Err(Refusal::because("no tool change is half way"));
        };
        let (back, one_step) = match order {
            SequenceOrder::GoOn => (false, false),
            SequenceOrder::Undo => (true, false),
            SequenceOrder::Step => (false, true),
            _ => (true, true),
        };
        let sequence = &changer.sequence;
        let Some(step) = sequence.steps.get(stage.step) else {
            return Err(Refusal::because("its step is not known: bring it to rest by hand"));
        };
        if back && step.undone_by_hand {
            let name = &step.name;
            return Err(Refusal::because(format!(
                "step \"{name}\" is undone by a person alone: bring it to rest by hand, then say sequence done TOOL"
            )));
        }
        self.check_places(sequence, &stage)?;
        let tool = if back { stage.change.from } else { stage.change.to };
        Ok((format!("T{tool} M6"), Resume { stage, back, one_step }))
    }

    /// Axes stand where the step begins, unless it moves them itself.
    fn check_places(&self, sequence: &Sequence, stage: &SequenceStage) -> Result<(), Refusal> {
        let place = self.position();
        let own = &sequence.steps[stage.step].to;
        let mut needed = Vec::new();
        for index in sequence.steps_of(&stage.change).take_while(|index| *index < stage.step) {
            for (axis, at) in &sequence.steps[index].to {
                needed.retain(|(known, _)| known != axis);
                needed.push((*axis, *at));
            }
        }
        needed.retain(|(axis, _)| !own.iter().any(|(moved, _)| moved == axis));
        for (axis, at) in needed {
            let (is, should) = (place.along(axis).value(), at.value());
            if (is - should).abs() > OFF_MM {
                let (letter, step) = (axis.letter(), &sequence.steps[stage.step].name);
                return Err(Refusal::because(format!(
                    "{letter} is at {is:.3}, and step \"{step}\" needs it at {should:.3}: bring everything to rest by hand, then say sequence done TOOL"
                )));
            }
        }
        Ok(())
    }

    /// What an operator says of changer and magazine.
    pub(super) fn sequence(&mut self, order: SequenceOrder) -> Result<Accepted, Refusal> {
        match order {
            SequenceOrder::GoOn
            | SequenceOrder::Undo
            | SequenceOrder::Step
            | SequenceOrder::StepBack => match self.begin(&Request::Sequence(order)) {
                super::Begun::Answered(answer) => return answer,
                super::Begun::Proving(proving) => {
                    return self.complete(proving.planned().prove());
                }
            },
            SequenceOrder::Done(tool) => self.done_by_hand(tool)?,
            SequenceOrder::Carousel(pocket) => {
                let changer = self.changer_of_machine()?;
                check_pocket(&changer.magazine, pocket, 1)?;
                changer.magazine.at = Some(pocket);
            }
            SequenceOrder::Pocket(pocket, tool) => {
                let is_known = tool == 0 || self.data.tools.get(tool).is_some();
                let changer = self.changer_of_machine()?;
                check_pocket(&changer.magazine, pocket, 0)?;
                if !is_known {
                    return Err(Refusal::because(format!("T{tool} is not in the tool table")));
                }
                put(&mut changer.magazine, pocket, tool);
            }
        }
        self.data.rest_number += 1; // what was proved before was proved for another magazine
        self.keep_changer()?;
        Ok(Accepted::default())
    }

    fn changer_of_machine(&mut self) -> Result<&mut Changer, Refusal> {
        self.changer.as_mut().ok_or_else(|| {
            Refusal::because(
                "the tool change of this machine is no sequence: it has no magazine here",
            )
        })
    }

    /// Everything is at rest, and no tool is missing.
    fn done_by_hand(&mut self, tool: u32) -> Result<(), Refusal> {
        let wrong = self.wrong_at_rest();
        let all = |magazine: &Magazine, change: &ToolChange| {
            let mut all = magazine.tools();
            all.extend([change.from, change.to].into_iter().filter(|tool| *tool != 0));
            all.sort_unstable();
            all.dedup();
            all
        };
        let changer = self.changer_of_machine()?;
        let Some(stage) = changer.stage else {
            return Err(Refusal::because("no tool change is half way"));
        };
        if !wrong.is_empty() {
            return Err(Refusal::because(format!("it is not at rest: {}", wrong.join(", "))));
        }
        let mut magazine = changer.magazine.clone();
        let known = all(&magazine, &stage.change);
        if magazine.spindle != tool {
            let home = magazine.pocket_of(tool).unwrap_or(0);
            put(&mut magazine, home, 0);
            (magazine.spindle, magazine.home) = (tool, home);
        }
        let now = magazine.tools();
        if let Some(missing) = known.iter().find(|tool| !now.contains(tool)) {
            return Err(Refusal::because(format!(
                "where is T{missing}? It is in no pocket and not in the spindle: first say pocket P T{missing}, pocket 0 if it is not in the machine"
            )));
        }
        (changer.magazine, changer.stage) = (magazine, None);
        Ok(())
    }

    /// Inputs that are not as they are at rest, each in words.
    fn wrong_at_rest(&self) -> Vec<String> {
        let Some(changer) = &self.changer else { return Vec::new() };
        let inputs = self.executor.machine.feedback().inputs;
        let wrong = changer.sequence.rest_inputs.iter();
        let wrong = wrong.filter(|(number, on)| inputs.is_on(*number) != *on);
        wrong
            .map(|(number, on)| {
                let (is, should) = if *on { ("off", "on") } else { ("on", "off") };
                format!("\"{}\" is {is} and should be {should}", self.input_name(*number))
            })
            .collect()
    }

    fn input_name(&self, number: u8) -> String {
        let names = self.base.machine.inputs.digital.iter();
        let known = names.clone().find(|(known, _)| *known == number);
        known.map_or_else(|| format!("input {number}"), |(_, name)| name.clone())
    }

    /// How far a tool change is.
    pub fn sequence_status(&self) -> Option<SequenceStatus> {
        let changer = self.changer.as_ref()?;
        let stage = changer.stage?;
        let step = changer.sequence.steps.get(stage.step)?;
        let inputs = self.executor.machine.feedback().inputs;
        let expected = changer.sequence.expected(&stage).into_iter();
        Some(SequenceStatus {
            name: changer.sequence.name.clone(),
            step: step.name.clone(),
            number: stage.step as u32 + 1,
            of: changer.sequence.steps.len() as u32,
            is_back: stage.back,
            is_half_way: self.under_way.is_none(),
            is_undone_by_hand: step.undone_by_hand,
            from: stage.change.from,
            to: stage.change.to,
            operator: step.operator.clone(),
            inputs: expected
                .map(|(number, should_be)| SequenceInput {
                    name: self.input_name(number),
                    is: inputs.is_on(number),
                    should_be,
                })
                .collect(),
        })
    }

    /// Where the tools are; `None`: no sequence works the changer.
    pub fn magazine_status(&self) -> Option<MagazineStatus> {
        let Magazine { pockets, spindle, at, .. } = self.changer.as_ref()?.magazine.clone();
        Some(MagazineStatus { pockets, spindle, at })
    }
}

fn change_of(left: &HalfWay) -> ToolChange {
    ToolChange {
        from: left.from,
        returns_to: left.returns_to,
        to: left.to,
        fetched_from: left.fetched_from,
    }
}

/// Where a sequence was left; `None`: it has no such step.
fn stage_of(sequence: &Sequence, left: &HalfWay) -> Option<SequenceStage> {
    let step = sequence.steps.iter().position(|step| step.name == left.step)?;
    (sequence.name == left.sequence).then(|| SequenceStage {
        step,
        back: left.back,
        change: change_of(left),
    })
}

fn check_pocket(magazine: &Magazine, pocket: u32, least: u32) -> Result<(), Refusal> {
    let most = magazine.pockets.len() as u32;
    if (least..=most).contains(&pocket) {
        return Ok(());
    }
    Err(Refusal::because(format!("there is no pocket {pocket}: the magazine has 1 to {most}")))
}

/// A tool is in a pocket, and nowhere else; pocket 0 is no pocket.
fn put(magazine: &mut Magazine, pocket: u32, tool: u32) {
    if tool != 0 {
        for held in magazine.pockets.iter_mut().filter(|held| **held == tool) {
            *held = 0;
        }
        if magazine.spindle == tool {
            (magazine.spindle, magazine.home) = (0, 0);
        }
    }
    if let Some(held) = (pocket as usize).checked_sub(1).and_then(|at| magazine.pockets.get_mut(at))
    {
        *held = tool;
    }
}
