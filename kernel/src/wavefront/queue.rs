//! Which samples are under way, and those that wait for others.

use core::ops::Range;

use crate::film::Pixel;

/// How far samples that are under way may be apart.
const WINDOW: usize = 512;

/// A sample that starts.
pub(super) struct Start {
    /// Its pixel, counted from the first one.
    pub(super) pixel: u32,
    pub(super) sample: u32,
    /// Its place among all.
    pub(super) place: usize,
}

/// The samples of a stretch of pixels. Paths end in any order; what they found is added in the order of samples, since
/// the last bit of a pixel's variance depends on it.
pub(super) struct Queue<'p> {
    pixels: &'p mut [Pixel],
    samples: Range<u32>,
    started: Cursor,
    added: Cursor,
    waiting: [[f32; 3]; WINDOW],
    has_ended: [bool; WINDOW],
}

/// A place among all samples, with its pixel and number.
#[derive(Clone, Copy)]
struct Cursor {
    place: usize,
    pixel: usize,
    sample: u32,
}

impl Cursor {
    #[inline(always)]
    fn advance(&mut self, samples: &Range<u32>) {
        self.place += 1;
        self.sample += 1;
        if self.sample == samples.end {
            self.sample = samples.start;
            self.pixel += 1;
        }
    }
}

impl<'p> Queue<'p> {
    pub(super) fn new(pixels: &'p mut [Pixel], samples: Range<u32>) -> Self {
        let first = Cursor { place: 0, pixel: 0, sample: samples.start };
        Self { pixels, samples, started: first, added: first, waiting: [[0.0; 3]; WINDOW], has_ended: [false; WINDOW] }
    }

    /// The next sample; `None` where there is none, or where it has to wait for one that takes long.
    #[inline(always)]
    pub(super) fn start(&mut self) -> Option<Start> {
        let Cursor { place, pixel, sample } = self.started;
        if pixel >= self.pixels.len() || self.samples.is_empty() || place - self.added.place >= WINDOW {
            return None;
        }
        self.started.advance(&self.samples);
        Some(Start { pixel: pixel as u32, sample, place })
    }

    /// How many have started.
    #[inline(always)]
    pub(super) fn started(&self) -> usize {
        self.started.place
    }

    /// What the sample at `place` found. It is added by [`Queue::add_ended`].
    #[inline(always)]
    pub(super) fn end(&mut self, place: usize, radiance: [f32; 3]) {
        self.waiting[place % WINDOW] = radiance;
        self.has_ended[place % WINDOW] = true;
    }

    /// Adds what has been found to the pixels, up to the first sample that is under way.
    #[inline(always)]
    pub(super) fn add_ended(&mut self) {
        while let Some(pixel) = self.pixels.get_mut(self.added.pixel) {
            let mut sum = *pixel;
            let first = self.added.pixel;
            while self.added.pixel == first && self.has_ended[self.added.place % WINDOW] {
                let at = self.added.place % WINDOW;
                self.has_ended[at] = false;
                sum.add(self.waiting[at]);
                self.added.advance(&self.samples);
            }
            *pixel = sum;
            if self.added.pixel == first {
                return;
            }
        }
    }
}
