//! The kernel in its servo thread, between the rings.
use crate::message::{Replied, Said};
use crate::stop_lane::stop;
use kernel::{Kernel, Reply, Request};
use motion::{Readable, Step};

/// The rings' ends on the servo thread's side. Nothing here waits, and nothing takes memory.
pub trait Rings {
    /// Where the plans of its steps are.
    type Storage: Readable;

    /// The next request, while there is room for its reply.
    fn next_request(&mut self) -> Option<Request>;
    /// What came of the request that was taken last.
    fn reply(&mut self, replied: Replied);
    /// The next step.
    fn next_step(&mut self) -> Option<Step<Self::Storage>>;
    /// Steps that [`Rings::next_step`] has not handed out yet.
    fn steps_waiting(&self) -> usize;
    /// A step is done with.
    fn release(&mut self, step: Step<Self::Storage>);
    /// There is room for something to say.
    fn can_say(&self) -> bool;
    /// Say something; what there is no room for is lost.
    fn say(&mut self, said: Said);
    /// Flags of the [`StopLane`](crate::StopLane), taken.
    fn stops(&mut self) -> u32;
}

/// A kernel, and its side of the rings.
pub struct Seat<R: Rings> {
    /// The kernel.
    pub kernel: Box<Kernel>,
    /// The rings.
    pub rings: R,
    /// A step that the kernel had no room for.
    waiting: Option<Step<R::Storage>>,
    taken: u64,
    /// Of the steps on their way, those after this one up to that one were given up.
    given_up: (u64, u64),
    number: u64,
}

impl<R: Rings> Seat<R> {
    /// Before its first period.
    pub const fn new(kernel: Box<Kernel>, rings: R) -> Self {
        Self { kernel, rings, waiting: None, taken: 0, given_up: (0, 0), number: 0 }
    }

    /// Steps that have gone into the kernel's queue, of all that were sent.
    pub const fn taken(&self) -> u64 {
        self.taken
    }

    /// Periods that are over.
    pub const fn number(&self) -> u64 {
        self.number
    }

    /// Before a tick: stops act, requests are answered, and steps go into the kernel's queue. The
    /// flags of the stops.
    pub fn before_tick(&mut self) -> u32 {
        let flags = self.rings.stops();
        stop(&mut self.kernel, flags);
        self.serve();
        self.take_steps();
        flags
    }

    /// After a tick: what the kernel has said is handed on, and the period is over; its number.
    pub fn after_tick(&mut self) -> u64 {
        self.say();
        self.number += 1;
        self.number
    }

    /// Requests to the kernel, each with its reply.
    fn serve(&mut self) {
        while let Some(request) = self.rings.next_request() {
            let begins_anew = begins_anew(&request);
            let mut reply = match request {
                Request::GiveUp { steps, at } => Reply::Is(self.give_up(steps, at)),
                request => self.kernel.serve(request),
            };
            if begins_anew && !matches!(reply, Reply::Is(false)) {
                // what the control has sent before belongs to what the kernel has forgotten
                self.hand_back_waiting();
            }
            if let Reply::HandedBack(Some(back)) = &mut reply {
                back.steps += self.hand_back_waiting();
            }
            let (number, picture, taken) = (self.number, self.kernel.picture(), self.taken);
            self.rings.reply(Replied { reply, number, picture, taken });
        }
    }

    /// The last ones of all steps that were sent are not wanted any more, if the kernel agrees.
    fn give_up(&mut self, steps: usize, at: Option<f64>) -> bool {
        let on_their_way = self.rings.steps_waiting() + usize::from(self.waiting.is_some());
        let last = self.taken + on_their_way as u64;
        let of_kernel = steps.saturating_sub(on_their_way);
        if self.taken < self.given_up.1 || (steps < on_their_way && at.is_some()) {
            return false;
        }
        if (of_kernel > 0 || at.is_some() || steps == on_their_way)
            && !self.kernel.give_up(of_kernel, at)
        {
            return false;
        }
        self.given_up = (last - (steps - of_kernel) as u64, last);
        true
    }

    /// Steps on their way go back; how many.
    fn hand_back_waiting(&mut self) -> usize {
        let mut count = 0;
        while let Some(step) = self.waiting.take().or_else(|| self.rings.next_step()) {
            count += usize::from(!self.is_given_up());
            self.release(step);
        }
        count
    }

    /// Steps into the kernel's queue, as long as it has room.
    fn take_steps(&mut self) {
        while !self.kernel.is_full() {
            let Some(step) = self.waiting.take().or_else(|| self.rings.next_step()) else {
                return;
            };
            if self.is_given_up() {
                self.release(step);
                continue;
            }
            if self.kernel.push(&step).is_err() {
                self.waiting = Some(step); // no room for a plan of its kind: again after the next tick
                return;
            }
            self.release(step);
        }
    }

    /// The next step on its way was given up.
    fn is_given_up(&self) -> bool {
        (self.given_up.0..self.given_up.1).contains(&self.taken)
    }

    fn release(&mut self, step: Step<R::Storage>) {
        self.taken += 1;
        self.rings.release(step);
    }

    /// What there is no room for stays with the kernel: what the control must answer comes first,
    /// and of events the kernel keeps the last ones.
    fn say(&mut self) {
        let Self { kernel, rings, .. } = self;
        while rings.can_say() {
            let said = if let Some(answered) = kernel.take_answer() {
                Said::Answered(answered)
            } else if let Some(request) = kernel.next_record_request() {
                Said::Record(request)
            } else if let Some(event) = kernel.next_event() {
                Said::Event(event)
            } else {
                return;
            };
            rings.say(said);
        }
    }
}

/// The kernel forgets its steps for this: those on their way are forgotten, too.
const fn begins_anew(request: &Request) -> bool {
    matches!(
        request,
        Request::Clear
            | Request::SwitchOff
            | Request::SwitchOn
            | Request::Recover(_)
            | Request::Withdraw(_)
    )
}
