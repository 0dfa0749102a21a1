//! A machine whose tools a carousel brings, worked by its outputs.
use super::SimulatedMachine;
use crate::carousel::Carousel;
use crate::changer::Changer;
use crate::{CarouselMishap, CarouselTruth};

impl SimulatedMachine {
    /// What is true of its carousel.
    pub fn carousel(&self) -> Option<CarouselTruth> {
        self.carousel.as_ref().map(Carousel::truth)
    }

    /// Tools as a person has put them into its carousel and its spindle.
    pub fn load_carousel(&mut self, pockets: &[u32], spindle: u32, at: Option<u32>) {
        if let Some(carousel) = &mut self.carousel {
            carousel.load(pockets, spindle, at);
            self.changer = Changer::Holds(spindle);
            self.feedback.tool = self.changer.tool();
        }
    }

    /// Something fails on its carousel; `None`: everything is mended.
    pub fn fail_carousel(&mut self, mishap: Option<CarouselMishap>) {
        if let Some(carousel) = &mut self.carousel {
            match mishap {
                Some(mishap) => carousel.fail(mishap),
                None => carousel.mend(),
            }
        }
    }

    /// The tool that is really in the spindle.
    pub(super) fn mounted(&self) -> Option<u32> {
        self.carousel.as_ref().map_or_else(|| self.changer.tool(), |own| Some(own.tool()))
    }

    pub(super) fn shown_inputs(&self) -> bus::Signals {
        let mut shown = self.inputs.shown();
        if let Some(carousel) = &self.carousel {
            carousel.inputs(&mut shown);
        }
        shown
    }
}
