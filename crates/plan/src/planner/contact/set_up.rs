//! What the tool is looked at against: the stock, its holes, the machine's bodies; and what changes
//! that on the way.
use super::{Contact, Mills};
use crate::bodies::Bodies;
use crate::planner::Planner;
use crate::stock::Stock;

impl Planner {
    /// One that also looks at the tool against this stock.
    #[must_use]
    pub fn with_stock(self, stock: Stock) -> Self {
        let rotary = self.programmed.rotary;
        Self { contact: Some(Contact::new(stock, rotary)), ..self }
    }

    /// One whose tools are assumed and not the shop's own: what they would do to the stock is worth
    /// a warning at most.
    #[must_use]
    pub fn with_assumed_tools(mut self) -> Self {
        if let Some(contact) = &mut self.contact {
            contact.doubtful = true;
        }
        self
    }

    /// One whose stock is what the program says that it is.
    #[must_use]
    pub const fn with_stated_stock(mut self) -> Self {
        if let Some(contact) = &mut self.contact {
            contact.mills = Mills::All;
        }
        self
    }

    /// One that also looks at these bodies of the machine.
    #[must_use]
    pub const fn with_bodies(mut self, bodies: Bodies) -> Self {
        if let Some(contact) = &mut self.contact {
            contact.bodies = bodies;
        }
        self
    }

    /// One whose work has holes already: where, how wide and how deep from its top, mm.
    #[must_use]
    pub fn with_holes(mut self, holes: impl IntoIterator<Item = ([f64; 2], [f64; 2])>) -> Self {
        if let Some(contact) = &mut self.contact {
            for (at, [diameter, depth]) in holes {
                contact.removed.bore(at, diameter, 0.0, depth);
            }
        }
        self
    }

    /// A probing move is made.
    pub(in crate::planner) const fn has_probed(&mut self) {
        if let Some(contact) = &mut self.contact {
            contact.probed = true;
        }
    }

    /// Another tool is in the spindle.
    pub(in crate::planner) const fn tool_mounted(&mut self) {
        if let Some(contact) = &mut self.contact {
            contact.mounted += 1;
            contact.entered = None;
            contact.offset_said = false;
            contact.blamed = None;
            contact.crashed = false;
        }
    }
}
