//! What lies between the window and the thread that renders: the window leaves what it wants and never waits.

use crate::shown::Shown;
use render::{CompiledScene, LoadedScene, RenderSettings, ToneCurve};
use scene::Camera;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// The picture that the window wants.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Where it is taken from.
    pub camera: Camera,
    /// Its size in the window and how it is computed.
    pub settings: RenderSettings,
    /// What of it is shown.
    pub shown: Shown,
    /// In stops; `None` chooses it from the picture.
    pub exposure: Option<f32>,
    /// What becomes of bright parts.
    pub tone_curve: ToneCurve,
    /// Whether the camera is in motion.
    pub is_moving: bool,
    /// Whether nobody can see it.
    pub is_hidden: bool,
}

impl Request {
    /// Whether what was rendered for one serves the other.
    pub fn shares_film(&self, other: &Self) -> bool {
        self.camera == other.camera
            && self.settings == other.settings
            && self.shown.is_layer() == other.shown.is_layer()
    }
}

/// A scene that is ready to be rendered.
pub struct Delivery {
    /// In the memory of the device.
    pub loaded: Box<dyn LoadedScene>,
    /// The same for looking things up.
    pub compiled: Arc<CompiledScene>,
    /// What users call the device.
    pub device: String,
    /// Whether it is the processor.
    pub is_processor: bool,
}

/// What is new on the desk.
#[derive(Default)]
pub struct News {
    /// The last request, if it is new.
    pub request: Option<Request>,
    /// The last scene, if it is new.
    pub delivery: Option<Delivery>,
    /// Whether to end.
    pub is_over: bool,
}

/// The desk.
#[derive(Default)]
pub struct Desk {
    drawer: Mutex<Drawer>,
    bell: Condvar,
    /// Counts what makes work in progress useless.
    interruptions: AtomicU64,
    is_over: AtomicBool,
}

#[derive(Default)]
struct Drawer {
    news: News,
    last: Option<Request>,
}

impl Desk {
    fn drawer(&self) -> MutexGuard<'_, Drawer> {
        self.drawer.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks for a picture, instead of the one that was asked for before.
    pub fn ask(&self, request: Request) {
        let mut drawer = self.drawer();
        if drawer.last.as_ref() == Some(&request) {
            return;
        }
        if !drawer.last.as_ref().is_some_and(|last| last.shares_film(&request)) {
            self.interruptions.fetch_add(1, Ordering::Release);
        }
        drawer.last = Some(request.clone());
        drawer.news.request = Some(request);
        self.bell.notify_all();
    }

    /// Brings a scene, instead of the one that was there before.
    pub fn deliver(&self, delivery: Delivery) {
        self.drawer().news.delivery = Some(delivery);
        self.interruptions.fetch_add(1, Ordering::Release);
        self.bell.notify_all();
    }

    /// Ends the work.
    pub fn end(&self) {
        self.is_over.store(true, Ordering::Release);
        self.drawer().news.is_over = true;
        self.interruptions.fetch_add(1, Ordering::Release);
        self.bell.notify_all();
    }

    /// Whether the work is over.
    pub fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Acquire)
    }

    /// How often work in progress became useless.
    pub fn interruptions(&self) -> u64 {
        self.interruptions.load(Ordering::Acquire)
    }

    /// Takes what is new; waits for something unless there is other work.
    pub fn take(&self, has_work: bool) -> News {
        let mut drawer = self.drawer();
        loop {
            let News { request, delivery, is_over } = &drawer.news;
            if has_work || *is_over || request.is_some() || delivery.is_some() {
                let is_over = *is_over;
                return News { is_over, ..std::mem::take(&mut drawer.news) };
            }
            drawer = self.bell.wait(drawer).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request() -> Request {
        Request {
            camera: Camera::default(),
            settings: RenderSettings::default(),
            shown: Shown::Picture,
            exposure: None,
            tone_curve: ToneCurve::default(),
            is_moving: false,
            is_hidden: false,
        }
    }

    #[test]
    fn only_what_needs_another_film_interrupts() {
        let desk = Desk::default();
        desk.ask(request());
        let before = desk.interruptions();
        desk.ask(Request { exposure: Some(1.0), ..request() });
        desk.ask(Request { tone_curve: ToneCurve::Reinhard, ..request() });
        desk.ask(Request { shown: Shown::Cost, is_moving: true, ..request() });
        assert_eq!(desk.interruptions(), before);
        desk.ask(Request { shown: Shown::Depth, ..request() });
        assert_eq!(desk.interruptions(), before + 1);
        // The last one counts.
        assert_eq!(desk.take(false).request.unwrap().shown, Shown::Depth);
        assert!(desk.take(true).request.is_none());
        // The same again is nothing new.
        desk.ask(Request { shown: Shown::Depth, ..request() });
        assert!(desk.take(true).request.is_none());
    }

    #[test]
    fn whoever_waits_is_woken() {
        let desk = Arc::new(Desk::default());
        let other = Arc::clone(&desk);
        let waiter = std::thread::spawn(move || other.take(false).is_over);
        desk.end();
        assert!(waiter.join().unwrap() && desk.is_over());
    }
}
