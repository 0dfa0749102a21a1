//! Kernel and machine as the control holds them: here, or in the servo thread; what is asked of
//! them is the same.
mod machine;

pub use machine::MachineHandle;

use crate::real_time::KernelLink;
use bus::Report;
use kernel::{
    Answered, Event, Fault, FaultKind, Full, HomingOrder, Kernel, ManualOrder, ManualRefusal,
    Operator, Order, Periodic, RecordRequest, RecoveryPlan, Reply, Request, Waiting,
    WithdrawalPlan,
};
use motion::{HandedBack, Superpose, TableId, UnderWay, WayOut};
use plan::Step;
use servo::Record;
use units::{Angle, Axis, Coordinate, Length, Spin, Time};

/// A kernel.
pub enum KernelHandle {
    /// In this thread.
    Here(Box<Kernel>),
    /// In the servo thread.
    There(Box<KernelLink>),
}

impl From<Kernel> for KernelHandle {
    fn from(kernel: Kernel) -> Self {
        Self::Here(Box::new(kernel))
    }
}

/// What the kernel answers, or its picture has.
macro_rules! seen {
    ($($name:ident: $type:ty),* $(,)?) => {
        impl KernelHandle {
            $(
                #[doc = concat!("[`Kernel::", stringify!($name), "`].")]
                pub fn $name(&self) -> $type {
                    match self {
                        Self::Here(kernel) => kernel.$name(),
                        Self::There(link) => link.picture().$name,
                    }
                }
            )*
        }
    };
}

seen! {
    report: Report,
    is_over: bool,
    is_off: bool,
    is_ready: bool,
    is_standing: bool,
    is_retreating: bool,
    can_back_out: bool,
    is_in_thread: bool,
    is_moving_manually: bool,
    is_moving_on_lease: bool,
    has_faded: bool,
    coolant: [bool; 2],
    consulted: Option<u16>,
    engaged: Option<sync::recovery::Stored>,
    surface: Option<Length>,
    waiting: Option<Waiting>,
}

/// The same by axis.
macro_rules! seen_of_axis {
    ($($name:ident, $names:ident: $type:ty),* $(,)?) => {
        impl KernelHandle {
            $(
                #[doc = concat!("[`Kernel::", stringify!($name), "`].")]
                pub fn $name(&self, axis: Axis) -> $type {
                    match self {
                        Self::Here(kernel) => kernel.$name(axis),
                        Self::There(link) => link.picture().$names[axis.index()],
                    }
                }
            )*
        }
    };
}

seen_of_axis! {
    setpoint, setpoints: Option<Coordinate>,
    tool_side, tool_sides: Option<Coordinate>,
    is_homed, is_homed: bool,
    zero, zeros: Coordinate,
    shift, shifts: Coordinate,
}

/// What is done at once, or asked for: a thread that has ended does nothing any more.
macro_rules! done {
    ($($name:ident($($argument:ident: $type:ty),*) as $request:expr),* $(,)?) => {
        impl KernelHandle {
            $(
                #[doc = concat!("[`Kernel::", stringify!($name), "`].")]
                pub fn $name(&mut self $(, $argument: $type)*) {
                    match self {
                        Self::Here(kernel) => kernel.$name($($argument),*),
                        Self::There(link) => {
                            let _ = link.ask($request);
                        }
                    }
                }
            )*
        }
    };
}

done! {
    order(order: Order) as Request::Order(order),
    switch_on() as Request::SwitchOn,
    clear_outputs() as Request::ClearOutputs,
    rest_manually() as Request::RestManually,
    forget_home(axis: Axis) as Request::ForgetHome(axis),
    recover(plan: RecoveryPlan) as Request::Recover(plan),
    withdraw(plan: WithdrawalPlan) as Request::Withdraw(plan),
    go_on() as Request::GoOn,
    answer() as Request::Answer,
    keep_records() as Request::KeepRecords,
    acknowledge(number: u32) as Request::Acknowledge(number),
    not_written() as Request::NotWritten,
    forget_bands(tool: u32) as Request::ForgetBands(tool),
}

impl KernelHandle {
    /// The kernel, if it is in this thread.
    pub fn here(&mut self) -> Option<&mut Kernel> {
        match self {
            Self::Here(kernel) => Some(kernel),
            Self::There(_) => None,
        }
    }

    /// A period of the servo thread is looked at.
    pub(crate) fn see(&mut self, record: &Record) {
        if let Self::There(link) = self {
            link.see(record);
        }
    }

    /// [`Kernel::push`].
    ///
    /// # Errors
    /// There is no room for it now.
    pub fn push(&mut self, step: &Step) -> Result<(), Full> {
        match self {
            Self::Here(kernel) => kernel.push(step),
            Self::There(link) => link.push(step),
        }
    }

    /// No step can be pushed now.
    pub fn is_full(&self) -> bool {
        match self {
            Self::Here(kernel) => kernel.is_full(),
            Self::There(link) => link.is_full(),
        }
    }

    /// Steps that wait or run, those on their way to the kernel among them.
    pub fn steps(&self) -> usize {
        match self {
            Self::Here(kernel) => kernel.steps(),
            Self::There(link) => link.steps(),
        }
    }

    /// Nothing left to do.
    pub fn is_idle(&self) -> bool {
        self.steps() == 0
    }

    /// [`Kernel::operator`].
    pub fn operator(&self) -> &Operator {
        match self {
            Self::Here(kernel) => kernel.operator(),
            Self::There(link) => &link.picture().operator,
        }
    }

    /// [`Kernel::faults`].
    pub fn faults(&self) -> &[Fault] {
        match self {
            Self::Here(kernel) => kernel.faults(),
            Self::There(link) => link.faults(),
        }
    }

    /// [`Kernel::way_out`].
    pub fn way_out(&self) -> Option<&WayOut> {
        match self {
            Self::Here(kernel) => kernel.way_out(),
            Self::There(link) => link.picture().way_out.as_ref(),
        }
    }

    /// [`Kernel::ordered_spin`].
    pub fn ordered_spin(&self, spindle: usize) -> Spin {
        match self {
            Self::Here(kernel) => kernel.ordered_spin(spindle),
            Self::There(link) => {
                link.picture().ordered_spins.get(spindle).copied().unwrap_or_default()
            }
        }
    }

    /// [`Kernel::spindle_shift`].
    pub fn spindle_shift(&self, spindle: usize) -> Angle {
        match self {
            Self::Here(kernel) => kernel.spindle_shift(spindle),
            Self::There(link) => {
                link.picture().spindle_shifts.get(spindle).copied().unwrap_or_default()
            }
        }
    }

    /// An axis is being homed.
    pub fn is_homing(&self) -> bool {
        match self {
            Self::Here(kernel) => kernel.homing().next().is_some(),
            Self::There(link) => link.picture().is_homing.contains(&true),
        }
    }

    /// [`Kernel::next_event`].
    pub fn next_event(&mut self) -> Option<Event> {
        match self {
            Self::Here(kernel) => kernel.next_event(),
            Self::There(link) => link.next_event(),
        }
    }

    /// [`Kernel::take_answer`].
    pub fn take_answer(&mut self) -> Option<Answered> {
        match self {
            Self::Here(kernel) => kernel.take_answer(),
            Self::There(link) => link.take_answer(),
        }
    }

    /// [`Kernel::next_record_request`].
    pub fn next_record_request(&mut self) -> Option<RecordRequest> {
        match self {
            Self::Here(kernel) => kernel.next_record_request(),
            Self::There(link) => link.next_record_request(),
        }
    }

    /// [`Kernel::switch_off`].
    pub fn switch_off(&mut self) -> bool {
        match self {
            Self::Here(kernel) => kernel.switch_off(),
            Self::There(link) => matches!(link.ask(Request::SwitchOff), Some(Reply::Is(true))),
        }
    }

    /// [`Kernel::clear`].
    pub fn clear(&mut self) -> bool {
        match self {
            Self::Here(kernel) => kernel.clear(),
            Self::There(link) => matches!(link.ask(Request::Clear), Some(Reply::Is(true))),
        }
    }

    /// [`Kernel::hand_back`].
    pub fn hand_back(&mut self) -> Option<HandedBack> {
        match self {
            Self::Here(kernel) => kernel.hand_back(),
            // it would be refused, and the feeder asks in each period
            Self::There(link) if link.picture().is_flowing => None,
            Self::There(link) => match link.ask(Request::HandBack) {
                Some(Reply::HandedBack(back)) => back,
                _ => None,
            },
        }
    }

    /// The servo thread has ended by itself.
    pub(crate) fn lose(&mut self) {
        if let Self::There(link) = self {
            link.lose();
        }
    }

    /// Steps go another way than by [`KernelHandle::hand_back`], which would come too late for
    /// motion that is under way.
    pub(crate) fn moves_elsewhere(&self) -> bool {
        matches!(self, Self::There(link) if link.picture().is_flowing)
    }

    /// Steps on their way that were given up are not gone yet: no others can be given up.
    pub(crate) fn is_giving_up(&self) -> bool {
        matches!(self, Self::There(link) if link.is_giving_up())
    }

    /// [`Kernel::under_way`], and how many steps there are at that moment.
    pub fn under_way(&mut self) -> (Option<UnderWay>, usize) {
        let under_way = match self {
            Self::Here(kernel) => kernel.under_way(),
            Self::There(link) => match link.ask(Request::UnderWay) {
                Some(Reply::UnderWay(under_way)) => under_way,
                _ => None,
            },
        };
        (under_way, self.steps())
    }

    /// [`Kernel::give_up`].
    pub fn give_up(&mut self, steps: usize, at: Option<f64>) -> bool {
        match self {
            Self::Here(kernel) => kernel.give_up(steps, at),
            Self::There(link) => link.give_up(steps, at),
        }
    }

    /// [`Kernel::put_table`]; whether there was a place for it.
    pub fn put_table(&mut self, id: TableId, table: Periodic) -> bool {
        match self {
            Self::Here(kernel) => kernel.put_table(id, table).is_ok(),
            Self::There(link) => {
                matches!(link.ask(Request::PutTable(id, table)), Some(Reply::Table(Ok(_))))
            }
        }
    }

    /// [`Kernel::superpose`].
    ///
    /// # Errors
    /// The spindle, the axis or the table is missing, or the servo thread has ended.
    pub fn superpose(&mut self, order: &Superpose) -> Result<(), FaultKind> {
        match self {
            Self::Here(kernel) => kernel.superpose(order),
            Self::There(link) => match link.ask(Request::Superpose(*order)) {
                Some(Reply::Superposed(done)) => done,
                _ => Err(FaultKind::TableMissing),
            },
        }
    }

    fn manual(reply: Option<&Reply>) -> Result<(), ManualRefusal> {
        match reply {
            Some(Reply::Manual(done)) => *done,
            _ => Err(ManualRefusal::NotReady),
        }
    }

    /// [`Kernel::move_manually`].
    ///
    /// # Errors
    /// As there.
    pub fn move_manually(&mut self, axis: Axis, order: ManualOrder) -> Result<(), ManualRefusal> {
        match self {
            Self::Here(kernel) => kernel.move_manually(axis, order),
            Self::There(link) => {
                Self::manual(link.ask(Request::MoveManually(axis, order)).as_ref())
            }
        }
    }

    /// [`Kernel::turn_manually`].
    ///
    /// # Errors
    /// As there.
    pub fn turn_manually(
        &mut self,
        spindle: usize,
        spin: Spin,
        until: Time,
    ) -> Result<(), ManualRefusal> {
        match self {
            Self::Here(kernel) => kernel.turn_manually(spindle, spin, until),
            Self::There(link) => {
                Self::manual(link.ask(Request::TurnManually(spindle, spin, until)).as_ref())
            }
        }
    }

    /// [`Kernel::orient_manually`].
    ///
    /// # Errors
    /// As there.
    pub fn orient_manually(&mut self, spindle: usize, angle: Angle) -> Result<(), ManualRefusal> {
        match self {
            Self::Here(kernel) => kernel.orient_manually(spindle, angle),
            Self::There(link) => {
                Self::manual(link.ask(Request::OrientManually(spindle, angle)).as_ref())
            }
        }
    }

    /// [`Kernel::home`].
    ///
    /// # Errors
    /// As there.
    pub fn home(&mut self, axis: Axis, order: &HomingOrder) -> Result<(), ManualRefusal> {
        match self {
            Self::Here(kernel) => kernel.home(axis, order),
            Self::There(link) => Self::manual(link.ask(Request::Home(axis, *order)).as_ref()),
        }
    }
}
