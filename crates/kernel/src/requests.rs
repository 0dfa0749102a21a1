//! All that is asked of a kernel between two ticks, as data: what asks may be another thread, or
//! another process.
//!
//! ```text
//!   control ──Request──► ring ──► Kernel::serve ──► Reply ──► ring ──► control
//! ```
//!
//! Nothing here allocates: a table or a list comes with its memory, and what it replaces goes back
//! in the reply.
use crate::fault::FaultKind;
use crate::homing::HomingOrder;
use crate::kernel::Kernel;
use crate::manual::{ManualOrder, ManualRefusal};
use crate::operator::Order;
use crate::recovering::RecoveryPlan;
use crate::withdrawing::WithdrawalPlan;
use motion::{HandedBack, Superpose, TableId, UnderWay};
use sync::Periodic;
use units::{Angle, Axis, Spin, Time};

/// What a kernel is asked; each does what the method of its name does.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Request {
    /// [`Kernel::order`].
    Order(Order),
    /// [`Kernel::switch_on`].
    SwitchOn,
    /// [`Kernel::switch_off`].
    SwitchOff,
    /// [`Kernel::clear`].
    Clear,
    /// [`Kernel::clear_outputs`].
    ClearOutputs,
    /// [`Kernel::move_manually`].
    MoveManually(Axis, ManualOrder),
    /// [`Kernel::turn_manually`].
    TurnManually(usize, Spin, Time),
    /// [`Kernel::orient_manually`].
    OrientManually(usize, Angle),
    /// [`Kernel::rest_manually`].
    RestManually,
    /// [`Kernel::home`].
    Home(Axis, HomingOrder),
    /// [`Kernel::forget_home`].
    ForgetHome(Axis),
    /// [`Kernel::recover`].
    Recover(RecoveryPlan),
    /// [`Kernel::withdraw`].
    Withdraw(WithdrawalPlan),
    /// [`Kernel::go_on`].
    GoOn,
    /// [`Kernel::hand_back`]; `None` in motion: steps that are planned anew elsewhere come some
    /// periods later, and there must be none in which an axis that moves has no step. In motion
    /// there is [`Request::GiveUp`].
    HandBack,
    /// [`Kernel::under_way`].
    UnderWay,
    /// [`Kernel::give_up`].
    GiveUp {
        /// How many steps.
        steps: usize,
        /// Where the one under way ends.
        at: Option<f64>,
    },
    /// [`Kernel::superpose`].
    Superpose(Superpose),
    /// [`Kernel::answer`].
    Answer,
    /// [`Kernel::keep_records`].
    KeepRecords,
    /// [`Kernel::acknowledge`].
    Acknowledge(u32),
    /// [`Kernel::not_written`].
    NotWritten,
    /// [`Kernel::forget_bands`].
    ForgetBands(u32),
    /// [`Kernel::put_table`]; a table does not go to another process. The last one: bytes count
    /// variants, and what is left out has no number of its own.
    #[cfg_attr(feature = "serde", serde(skip))]
    PutTable(TableId, Periodic),
}

/// What came of it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Reply {
    /// It is done.
    Done,
    /// Whether it is so.
    Is(bool),
    /// It was accepted, or why not.
    Manual(Result<(), ManualRefusal>),
    /// What is given back.
    HandedBack(Option<HandedBack>),
    /// What is under way.
    UnderWay(Option<UnderWay>),
    /// It is superposed, or why not.
    Superposed(Result<(), FaultKind>),
    /// What the table has replaced, or the table itself where no place was free. The last one, as
    /// [`Request::PutTable`] is.
    #[cfg_attr(feature = "serde", serde(skip))]
    Table(Result<Option<Periodic>, Periodic>),
}

impl Kernel {
    /// Do what is asked; not during a tick.
    pub fn serve(&mut self, request: Request) -> Reply {
        match request {
            Request::SwitchOff => return Reply::Is(self.switch_off()),
            Request::Clear => return Reply::Is(self.clear()),
            Request::MoveManually(axis, order) => {
                return Reply::Manual(self.move_manually(axis, order));
            }
            Request::TurnManually(spindle, spin, until) => {
                return Reply::Manual(self.turn_manually(spindle, spin, until));
            }
            Request::OrientManually(spindle, angle) => {
                return Reply::Manual(self.orient_manually(spindle, angle));
            }
            Request::Home(axis, order) => return Reply::Manual(self.home(axis, &order)),
            Request::HandBack => {
                let stands = !self.is_flowing();
                return Reply::HandedBack(stands.then(|| self.hand_back()).flatten());
            }
            Request::UnderWay => return Reply::UnderWay(self.under_way()),
            Request::GiveUp { steps, at } => return Reply::Is(self.give_up(steps, at)),
            Request::PutTable(id, table) => return Reply::Table(self.put_table(id, table)),
            Request::Superpose(order) => return Reply::Superposed(self.superpose(&order)),
            Request::Order(order) => self.order(order),
            Request::SwitchOn => self.switch_on(),
            Request::ClearOutputs => self.clear_outputs(),
            Request::RestManually => self.rest_manually(),
            Request::ForgetHome(axis) => self.forget_home(axis),
            Request::Recover(plan) => self.recover(plan),
            Request::Withdraw(plan) => self.withdraw(plan),
            Request::GoOn => self.go_on(),
            Request::Answer => self.answer(),
            Request::KeepRecords => self.keep_records(),
            Request::Acknowledge(number) => self.acknowledge(number),
            Request::NotWritten => self.not_written(),
            Request::ForgetBands(tool) => self.forget_bands(tool),
        }
        Reply::Done
    }
}
